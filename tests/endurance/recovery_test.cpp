/// After an abort the rig is not at rest: the rim turns, and so does the wheel. The next maneuver begins at once.
#include "tests/catch.hpp"
#include "tests/endurance/truth.hpp"

using endurance::Outcome;
using endurance_test::cell;
using endurance_test::setup;
using rig::Phase;

namespace {

constexpr unsigned kDriveHealthy = 1U << static_cast<unsigned>(rig::Interlock::drive_healthy);

/// Runs the plan until `after_s` of `phase`; there the drive reports a fault, and is well again when the bridge has aborted.
Outcome struck(endurance::TestCell& rig, const rig::Plan& plan, Phase phase, double after_s) {
    double since_s = -1.0;
    const Outcome out = rig.run(plan, [&](const endurance::Period& period) {
        const auto now = static_cast<Phase>(period.sample.maneuver_state.phase);
        if (now == phase && since_s < 0.0) since_s = period.time_s;
        if (now == phase && period.time_s - since_s >= after_s) rig.rig().open_interlocks(kDriveHealthy);
        if (now == Phase::aborting) rig.rig().open_interlocks(0);
    });
    rig.rig().open_interlocks(0);
    return out;
}

/// What a wheel that turns when the drive is cut loses until it touches, as the rim pays it.
double lost_on_the_way_mps(const endurance::EnduranceSetup& s, const rig::Plan& plan) {
    const plc::Sledge& sledge = s.machinery.machinery.sledge;
    const double radps2 = sledge.wheel_drag_Nm / s.scenario.rig.rig.wheel.inertia_kgm2;
    return plan.wheel_share * plan.rolling_radius_m * radps2 * sledge.contact_m / sledge.speed_mps;
}

}  // namespace

TEST_CASE("after an abort in any phase the maneuver that follows at once is the one that was asked for", "[STUDY-070]") {
    const std::string name = GENERATE("light", "medium_a", "medium_b", "heavy", "rejected_takeoff", "open_loop", "endurance", "ramp", "step", "sweep",
                                      "slow_braking", "below_peak");
    struct Strike {
        Phase phase;
        double after_s;
    };
    const endurance::EnduranceSetup s = setup(name);
    for (const Strike strike : {Strike{Phase::spin_up, 1.0}, Strike{Phase::touchdown, 0.5}, Strike{Phase::settling, 0.02},
                                Strike{Phase::settling, 0.08}, Strike{Phase::settling, 0.5}, Strike{Phase::braking, 0.1}, Strike{Phase::braking, 0.6},
                                Strike{Phase::braking, 1.0}, Strike{Phase::standstill, 0.05}, Strike{Phase::retract, 0.5}}) {
        CAPTURE(name, rig::name(strike.phase), strike.after_s);
        auto rig = cell(s);
        const auto plan = rig::plan(s.scenario, 1, 1);
        const Outcome aborted = struck(rig, plan, strike.phase, strike.after_s);
        REQUIRE(aborted.abort == rig::Abort::drive_fault);
        const Outcome out = rig.run(plan);
        CHECK(out.phase == Phase::finished);
        CHECK(out.abort == rig::Abort::none);
        CHECK(out.figures.standstill);
        const double held_mps = endurance_test::held_to_mps(s, plan);
        CHECK(out.figures.brake_on_mps <= plan.speed_mps + held_mps);
        CHECK(out.figures.brake_on_mps >= plan.speed_mps - held_mps - lost_on_the_way_mps(s, plan));
    }
}

TEST_CASE("aborted again and again while the rim coasts, the maneuver still succeeds", "[STUDY-070]") {
    const std::string name = GENERATE("light", "endurance");
    CAPTURE(name);
    const endurance::EnduranceSetup s = setup(name);
    auto rig = cell(s);
    const auto plan = rig::plan(s.scenario, 1, 1);
    for (int i = 0; i < 5; ++i) REQUIRE(struck(rig, plan, Phase::settling, 0.1 * i).abort == rig::Abort::drive_fault);
    const Outcome out = rig.run(plan);
    CHECK(out.phase == Phase::finished);
    CHECK(out.figures.brake_on_mps == Approx(plan.speed_mps).margin(endurance_test::held_to_mps(s, plan) + lost_on_the_way_mps(s, plan)));
}
