/// The observed slip law on draws that nothing was tuned on, beside both baselines.
#include <fmt/format.h>

#include "plant_sim/study/robust/report.hpp"
#include "tests/catch.hpp"

using namespace robust;

TEST_CASE("on tyres, legs and speeds it was not made from the observed law keeps the brakes and the grip",
          "[STUDY-602]") {
    // Tuned on seed 1. Each family has all landings once.
    PlanOptions options;
    options.families = {"ring", "relaxation", "leg", "speed"};
    options.laws = {"observer", "threshold", "slip"};
    options.draws = 14;
    options.seed = 20261123;
    const Plan plan = load_plan(options);
    const std::vector<Summary> all = summarise(plan, run(plan, {.threads = 2}));
    INFO(to_table(plan, all));
    REQUIRE(all.size() == 12);
    for (std::size_t family = 0; family < 4; ++family) {
        const Summary& observer = all[3 * family];
        CHECK(observer.tripped == 0);
        CHECK(observer.mean_j_mu > all[3 * family + 1].mean_j_mu);  // the threshold law
        // A tenth of the travel of a valve that swings from limit to limit at 5 Hz, 400 mA/s.
        CHECK(observer.mean_travel_mAps < 400.0);
    }
    CHECK(all[0].mean_j_mu >= 0.940);
    CHECK(all[3].mean_j_mu >= 0.945);
    CHECK(all[2].mean_j_mu <
          all[0].mean_j_mu);  // the slip law's predictor on ring tyres: why this one is there
}
