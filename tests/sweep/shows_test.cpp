/// Section VI on a tenth of the full sweep: the first landings of the default seed at some of its references. The full one is
/// `rig-lab sweep`, which holds the same checks against itself.
#include <thread>

#include "plant_sim/study/sweep/run.hpp"
#include "plant_sim/study/sweep/summary.hpp"
#include "plant_sim/study/sweep/sweep_plan.hpp"
#include "plant_sim/study/team/shared_work.hpp"
#include "tests/catch.hpp"

TEST_CASE("the sweep shows what the paper's does: J_mu at 0.24, the trends of Fig. 13, the energies of Fig. 14", "[STUDY-148]") {
    sweep::SweepPlanOptions options;
    options.references = {0.06, 0.1, 0.15, 0.2, 0.24, 0.3, 0.36, 0.44};
    options.landings = 40;
    const sweep::SweepPlan plan = sweep::load_plan(options);
    const auto rows = sweep::run(plan, study::team::order_of_work(plan.stops()), {.threads = std::max(1U, std::thread::hardware_concurrency())});
    const sweep::Summary s = sweep::summarised(sweep::identity_of(plan), rows);
    CHECK(s.unchecked.empty());
    CHECK(s.checks.size() == 8);
    for (const sweep::Check& check : s.checks) {
        INFO(check.demand << ": " << check.measured);
        CHECK(check.passed);
    }
    // The slip law at 0.24 against the threshold law over the same landings.
    REQUIRE(s.threshold.has_value());
    CHECK(s.references[4].j_mu > s.threshold->j_mu);
    CHECK(s.references[4].stop_distance_m < s.threshold->stop_distance_m);
    CHECK(s.references[4].slip_efficiency > s.threshold->slip_efficiency);
}
