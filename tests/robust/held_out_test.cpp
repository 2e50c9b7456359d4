/// The slip law on draws that nothing was tuned on, beside the threshold law.
#include <fmt/format.h>

#include "plant_sim/study/robust/report.hpp"
#include "tests/catch.hpp"

using namespace robust;

TEST_CASE("on tyres, legs and speeds it was not made from the slip law keeps the brakes and the grip", "[STUDY-602]") {
    // Tuned on seed 1. Each family has all landings once.
    RobustPlanOptions options;
    options.families = {"ring", "relaxation", "leg", "speed"};
    options.laws = {"slip", "threshold"};
    options.draws = 14;
    options.seed = 20261123;
    const RobustPlan plan = load_plan(options);
    const std::vector<DrawnStop> rows = run(plan, {.threads = 2});
    const std::vector<Summary> all = summarise(plan, rows);
    INFO(to_table(plan, rows, all));
    REQUIRE(all.size() == 8);
    for (std::size_t family = 0; family < 4; ++family) {
        const Summary& slip = all[2 * family];
        CHECK(slip.brakes_released == 0);
        CHECK(slip.mean_j_mu > all[2 * family + 1].mean_j_mu);  // the threshold law
        // A tenth of the travel of a valve that swings from limit to limit at 5 Hz, 400 mA/s.
        CHECK(slip.mean_travel_mAps < 400.0);
    }
    CHECK(all[0].mean_j_mu >= 0.940);
    CHECK(all[2].mean_j_mu >= 0.945);
}
