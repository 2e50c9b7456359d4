/// What the valve leaves: against the held reference, and against the law that is told the peak.
#include "plant_sim/study/robust/soonest.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "plant_sim/study/robust/held_reference.hpp"
#include "plant_sim/study/robust/robust_campaign.hpp"
#include "tests/catch.hpp"

using namespace robust;

namespace {

RobustPlan grid(const std::string& family, const std::string& surface) {
    RobustPlanOptions options;
    options.families = {family};
    options.laws = {"told_peak", "soonest"};
    if (family == "brake_on") options.laws.emplace_back("wary");
    RobustPlan plan = load_plan(options);
    std::erase_if(plan.basis.landings, [&](const NominalLanding& landing) { return landing.surface != surface && landing.surface != "snow"; });
    return plan;
}

}  // namespace

TEST_CASE("a valve without lag leaves nearly the held reference, a delay takes from it", "[STUDY-602]") {
    const RobustPlan plan = load_plan({});
    for (const NominalLanding& landing : plan.basis.landings) {
        INFO(landing.surface << " " << landing.maneuver);
        rig::RigParameters rig = landing.rig;
        rig.brake_on_mps = 20.0;
        const auto with_delay = [&rig, &plan](double delay_s) {
            rig.valve.delay_s = delay_s;
            return 1.0 / soonest_j_mu(rig, plan.controller.slip, rig::peak(rig.surface).slip, 5.0, 1e-3);
        };
        rig.valve.natural_frequency_radps = 1e4;
        const double held = held_j_mu(rig, plan.controller.slip, rig::peak(rig.surface).slip, 5.0);
        const double fast = 1.0 / with_delay(0.0);
        CHECK(fast < held);
        CHECK(fast > 0.95 * held);
        // The release comes late by the delay, too, so that full current ends sooner.
        CHECK(with_delay(0.02) > 1.0 / fast);
        CHECK(with_delay(0.05) > with_delay(0.02));
    }
}

TEST_CASE("the law that is told the peak has less, at every speed of brake-on", "[STUDY-602]") {
    const RobustPlan plan = grid("brake_on", "wet_asphalt");
    const std::vector<DrawnStop> rows = run(plan, {.threads = 2});
    REQUIRE(rows.size() == plan.stops());
    const std::size_t stops = plan.draws_of(Family::brake_on);
    for (std::size_t i = 0; i < stops; ++i) {
        const DrawnStop &told = rows[i], &soonest = rows[stops + i], &wary = rows[2 * stops + i];
        REQUIRE(soonest.law == 1);
        REQUIRE(soonest.number == told.number);
        CHECK_FALSE(soonest.brakes_released());
        CHECK(told.figures.j_mu < soonest.figures.j_mu + 0.005);
        CHECK(soonest.figures.j_mu < 1.0);
        REQUIRE(wary.law == 2);
        CHECK(told.figures.j_mu < wary.figures.j_mu + 0.005);
        CHECK(wary.figures.j_mu < soonest.figures.j_mu + 0.002);  // soonest stays short of the reference until there is no current
    }
}

TEST_CASE("who does not know the runway ahead, and sees what is under the wheel later, has less", "[STUDY-602]") {
    const RobustPlan plan = load_plan({});
    for (const NominalLanding& landing : plan.basis.landings) {
        INFO(landing.surface << " " << landing.maneuver);
        rig::RigParameters rig = landing.rig;
        rig.brake_on_mps = 20.0;
        const double slip = rig::peak(rig.surface).slip;
        const auto wary = [&](double late_s) { return wary_j_mu(rig, plan.controller.slip, slip, 5.0, 1e-3, late_s); };
        CHECK(wary(0.0) < soonest_j_mu(rig, plan.controller.slip, slip, 5.0, 1e-3) + 0.001);
        if (landing.surface == "snow") {  // the first push has it at its peak
            CHECK(wary(0.1) > 0.99);
        } else {
            CHECK(wary(0.02) < wary(0.0) + 0.001);
            CHECK(wary(0.1) < wary(0.02) - 0.001);
        }
    }
}

TEST_CASE("laws that are bounds are of their grids alone", "[STUDY-602]") {
    RobustPlanOptions options;
    options.families = {"changes", "brake_on"};
    options.laws = {"wary"};
    CHECK_THROWS_AS(load_plan(options), std::invalid_argument);
    options.laws = {"soonest"};
    CHECK_NOTHROW(load_plan(options));
    options.families = {"brake_on"};
    options.laws = {"wary"};
    CHECK_NOTHROW(load_plan(options));
}

TEST_CASE("no change of surface is made good sooner than the valve's delay leaves it, none is later than 0.4 s", "[STUDY-602]") {
    const RobustPlan plan = grid("changes", "dry_asphalt");
    for (std::size_t i = 0; i < plan.basis.landings.size(); ++i) {
        const rig::RigParameters& from = plan.basis.landings[i].rig;
        const auto other = std::find_if(plan.basis.landings.begin(), plan.basis.landings.end(),
                                        [&from](const NominalLanding& landing) { return landing.rig.surface.name != from.surface.name; });
        const SoonestRegrip soonest = soonest_regrip(from, other->rig.surface, 40.0, 1e-3);
        INFO("from " << from.surface.name);
        CHECK(soonest.regrip.speed_mps == Approx(40.0).margin(0.1));
        REQUIRE(soonest.regrip.regained_s);
        CHECK(*soonest.regrip.regained_s > from.valve.delay_s);
        CHECK(*soonest.regrip.regained_s < 0.4);
        CHECK(soonest.j_mu > 0.9);
        CHECK(soonest.j_mu < 1.0);
    }
}
