/// A maneuver without mishap: order, conditions and outputs of every phase, time limits, plans that cannot be run.
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "tests/catch.hpp"
#include "tests/rig/rig_model.hpp"

using namespace sequencer_test;
using rig::Abort;
using rig::BrakeLaw;
using rig::Sequencer;

TEST_CASE("a maneuver goes through every phase once, in order, to its end", "[BRG-100]") {
    Sequencer s(landing());
    RigModel rig;
    double now = 1000.0;  // any clock
    std::vector<Phase> seen;
    const Outputs last = run(s, rig, now, [&](const Outputs& out) {
        if (seen.empty() || seen.back() != out.phase) seen.push_back(out.phase);
        return s.over();
    });
    const std::vector<Phase> all{Phase::idle,       Phase::spin_up, Phase::touchdown, Phase::settling, Phase::braking,
                                 Phase::standstill, Phase::retract, Phase::cool_down, Phase::finished};
    CHECK(seen == all);
    CHECK(last.abort == Abort::none);
    CHECK(safe(last));
    CHECK_FALSE(s.safe_end_seen());
}

TEST_CASE("what is on in each phase", "[BRG-100]") {
    const Plan plan = landing();
    Sequencer s(plan);
    RigModel rig;
    double now = 0.0;
    CHECK(safe(s.step(rig.inputs, now)));
    Outputs out = run_to(s, rig, now, Phase::spin_up);
    CHECK(out.drive_enable);
    CHECK(out.flywheel_set_mps == Approx(50.0 + 0.003 * 50.0 + 0.05).epsilon(1e-12));  // the wheel stands
    CHECK_FALSE(out.sledge_advance);
    CHECK_FALSE(out.arm);

    out = run_to(s, rig, now, Phase::touchdown);
    CHECK_FALSE(out.drive_enable);
    CHECK(out.sledge_advance);
    CHECK(out.load_enable);
    CHECK(out.load_base_N == plan.load_base_N);
    CHECK(out.load_lift_Ns2pm2 == plan.load_lift_Ns2pm2);
    CHECK(out.arm);
    CHECK_FALSE(out.weight_on_wheels);
    CHECK(out.demand_Pa == 0.0);

    out = run_to(s, rig, now, Phase::settling);
    CHECK(out.weight_on_wheels);
    CHECK(out.arm);
    CHECK(out.demand_Pa == 0.0);

    out = run_to(s, rig, now, Phase::braking);
    CHECK(out.demand_Pa == plan.demand_Pa);  // a step, at brake-on
    CHECK(out.slip_reference == plan.slip_reference);
    CHECK(out.weight_on_wheels);
    CHECK(out.load_enable);

    out = run_to(s, rig, now, Phase::standstill);
    CHECK(out.demand_Pa == plan.demand_Pa);
    const double stood = now;
    out = run(s, rig, now, [](const Outputs& o) { return o.demand_Pa == 0.0; });
    CHECK(now - stood == Approx(plan.hold_s).margin(2.0 * kStep_s));

    out = run_to(s, rig, now, Phase::retract);
    CHECK(safe(out));
    out = run_to(s, rig, now, Phase::cool_down);
    CHECK(safe(out));
    CHECK(rig.inputs.sledge_m <= plan.sledge_back_m);
    run_to(s, rig, now, Phase::finished);
    CHECK(rig.inputs.brake_temperature_C <= plan.cool_to_C);
}

TEST_CASE("the controller is armed before the sledge moves, from standby, wheel in the air", "[BRG-100]") {
    Sequencer s(landing());
    RigModel rig;
    double now = 0.0;
    const Outputs armed = run(s, rig, now, [](const Outputs& out) { return out.arm; });
    CHECK(armed.phase == Phase::spin_up);
    CHECK(rig.inputs.controller_standby);
    // A controller that never says that it is armed is not waited for with the wheel on the rim.
    Inputs deaf = rig.inputs;
    deaf.controller_standby = true;
    deaf.controller_armed = false;
    Outputs out;
    for (int i = 0; i < 100; ++i) {
        out = s.step(deaf, now += kStep_s);
        REQUIRE(out.phase == Phase::spin_up);
        REQUIRE_FALSE(out.sledge_advance);
    }
}

TEST_CASE("brake-on comes at the prescribed speed, at once where it has been passed already", "[BRG-100]") {
    struct Case {
        double coasting_mps, loss_mps2, wheel_share, expected_mps;
    };
    const auto c = GENERATE(Case{0.05, 0.02, 0.003, 50.0},   // as planned
                            Case{0.06, 0.02, 0.010, 49.66},  // a heavier wheel than the plan's: below when settled
                            Case{0.0, 0.0, 0.003, 50.0});    // no drag at all
    Plan plan = landing();
    plan.coasting_mps = c.coasting_mps;
    Sequencer s(plan);
    RigModel rig;
    rig.rolling_loss_mps2 = c.loss_mps2;
    rig.wheel_share = c.wheel_share;
    double now = 0.0;
    const Outputs out = run_to(s, rig, now, Phase::braking);
    REQUIRE(out.phase == Phase::braking);
    CHECK(rig.inputs.flywheel_mps == Approx(c.expected_mps).margin(plan.speed_tolerance_mps));
    CHECK(rig.inputs.flywheel_mps <= plan.speed_mps + plan.speed_tolerance_mps);
}

TEST_CASE("the set-point is what leaves the prescribed speed after touchdown, whatever the wheel does before it", "[BRG-100]") {
    // From a standing rig to one that an abort in settling has left: rim and wheel as they coast.
    struct Left {
        double rim_mps, wheel_mps;
    };
    const auto left =
        GENERATE(Left{0.0, 0.0}, Left{30.0, 29.8}, Left{30.0, 0.0}, Left{48.0, 48.0}, Left{50.0, 50.0}, Left{50.02, 49.0}, Left{0.0, 20.0});
    CAPTURE(left.rim_mps, left.wheel_mps);
    Sequencer s(landing());
    RigModel rig;
    rig.inputs.flywheel_mps = rig.inputs.rim_mps = left.rim_mps;
    rig.inputs.wheel_radps = left.wheel_mps / kWheelRadius_m;
    double now = 0.0;
    run_to(s, rig, now, Phase::braking);
    REQUIRE(s.phase() == Phase::braking);
    // The wheel goes on losing speed until it touches: 3 rad/s2 for 2.5 s, of which the rim pays 0.003.
    const double lost_mps = 0.003 * 3.0 * 2.5 * kWheelRadius_m;
    CHECK(rig.inputs.flywheel_mps == Approx(50.0).margin(0.02 + lost_mps));
}

TEST_CASE("the set-point follows a wheel that slows down in few steps, each of half the tolerance", "[BRG-100]") {
    const Plan plan = landing();
    Sequencer s(plan);
    RigModel rig;
    rig.inputs.wheel_radps = 50.0 / kWheelRadius_m;
    double now = 0.0;
    run_to(s, rig, now, Phase::spin_up);
    rig.inputs.controller_standby = rig.inputs.controller_armed = false;  // it takes its time
    std::set<double> set_points;
    for (int i = 0; i < 6000; ++i) {
        const Outputs out = s.step(rig.inputs, now += kStep_s);
        REQUIRE(out.phase == Phase::spin_up);
        set_points.insert(out.flywheel_set_mps);
        const double exact_mps = 50.0 + plan.wheel_share * (50.0 - kWheelRadius_m * rig.inputs.wheel_radps) + plan.coasting_mps;
        REQUIRE(std::abs(out.flywheel_set_mps - exact_mps) <= 0.5 * plan.speed_tolerance_mps);
        rig.advance(out, kStep_s);
        rig.inputs.controller_standby = rig.inputs.controller_armed = false;
    }
    CHECK(rig.inputs.wheel_radps == 0.0);
    CHECK(set_points.size() >= 14);
    CHECK(set_points.size() <= 17);
}

TEST_CASE("no brake-on far below the prescribed speed, nor above it, nor before the wheel has settled", "[BRG-100]") {
    const auto mishap = GENERATE(0, 1, 2, 3, 4);
    Sequencer s(landing());
    RigModel rig;
    double now = 0.0;
    run_to(s, rig, now, Phase::settling);
    Inputs in = rig.inputs;
    in.flywheel_mps = in.rim_mps = in.wheel_rim_mps = 49.9;
    in.load_N = 30e3 - 3.0 * 49.9 * 49.9;
    in.controller_armed = true;
    if (mishap == 0) in.flywheel_mps = in.rim_mps = in.wheel_rim_mps = 47.0;
    if (mishap == 1) in.flywheel_mps = in.rim_mps = in.wheel_rim_mps = 50.03;
    if (mishap == 2) in.wheel_rim_mps = 48.0;
    if (mishap == 3) in.load_N = 5e3;
    if (mishap == 4) in.wheel_on_rim = false;
    Outputs out;
    while (now < 600.0) {
        out = s.step(in, now += kStep_s);
        REQUIRE(out.demand_Pa == 0.0);
        if (out.phase == Phase::aborting) break;
        REQUIRE(out.phase == Phase::settling);
    }
    CHECK(out.abort == Abort::phase_timeout);
}

TEST_CASE("settling starts anew whenever the wheel slips", "[BRG-100]") {
    Sequencer s(landing());
    RigModel rig;
    double now = 0.0;
    run_to(s, rig, now, Phase::settling);
    for (int i = 0; i < 500; ++i) {
        Inputs in = rig.inputs;
        in.flywheel_mps = 49.9;
        in.wheel_rim_mps = i % 15 == 0 ? 45.0 : 49.9;  // never quiet for settle_hold_s
        in.load_N = 30e3 - 3.0 * 49.9 * 49.9;
        in.controller_armed = true;
        REQUIRE(s.step(in, now += kStep_s).phase == Phase::settling);
    }
}

TEST_CASE("open loop: the current counts from brake-on, linear between points and held beyond", "[BRG-100]") {
    Plan plan = landing();
    plan.law = BrakeLaw::open_loop;
    plan.current = {{0.5, 4.0}, {1.0, 10.0}, {2.0, 8.0}};
    Sequencer s(plan);
    RigModel rig;
    double now = 0.0;
    const double on = (run_to(s, rig, now, Phase::braking), now);
    const auto at = [&](double t) { return run(s, rig, now, [&](const Outputs&) { return now >= on + t - 1e-9; }).current_mA; };
    CHECK(at(0.0) == 4.0);
    CHECK(at(0.5) == Approx(4.0));
    CHECK(at(0.75) == Approx(7.0).margin(0.13));
    CHECK(at(1.5) == Approx(9.0).margin(0.03));
    CHECK(at(2.5) == 8.0);
    const Outputs out = run(s, rig, now, [](const Outputs& o) { return o.demand_Pa == 0.0; });
    CHECK(out.current_mA == 0.0);
}

TEST_CASE("every phase has a time limit", "[BRG-110]") {
    const Phase phase =
        GENERATE(Phase::idle, Phase::spin_up, Phase::touchdown, Phase::settling, Phase::braking, Phase::standstill, Phase::retract, Phase::cool_down);
    Plan plan = landing();
    plan.idle_limit_s = 5.0;
    plan.spin_up_limit_s = 20.0;
    plan.touchdown_limit_s = 4.0;
    plan.settling_limit_s = 6.0;
    plan.braking_limit_s = 15.0;
    plan.standstill_limit_s = 3.0;
    plan.retract_limit_s = 7.0;
    plan.cool_down_limit_s = 40.0;
    const double limits[] = {5.0, 20.0, 4.0, 6.0, 15.0, 3.0, 7.0, 40.0};
    Sequencer s(plan);
    RigModel rig;
    double now = 0.0;
    run_to(s, rig, now, phase);
    REQUIRE(s.phase() == phase);
    Inputs stuck = rig.inputs;
    if (phase == Phase::idle) stuck.flywheel_mps = stuck.rim_mps = 51.0;  // above the set-point
    if (phase == Phase::settling) stuck.wheel_rim_mps = 0.0;
    if (phase == Phase::standstill) stuck.pressure_Pa = 5e6;
    if (phase == Phase::braking) stuck.load_N = 30e3 - 3.0 * stuck.flywheel_mps * stuck.flywheel_mps;
    stuck.controller_armed = phase != Phase::idle && phase != Phase::spin_up;
    stuck.controller_standby = !stuck.controller_armed;
    if (phase == Phase::cool_down) stuck.brake_temperature_C = 250.0;
    const double from = now;
    Outputs out;
    while (now < from + 100.0) {
        out = s.step(stuck, now);
        if (out.phase != phase) break;
        now += kStep_s;
    }
    CHECK(out.phase == Phase::aborting);
    CHECK(out.abort == Abort::phase_timeout);
    CHECK(now - from == Approx(limits[static_cast<std::size_t>(phase)]).margin(3.0 * kStep_s));
    CHECK(safe(out));
}

TEST_CASE("a plan that cannot be run is refused by name", "[BRG-120]") {
    struct Bad {
        const char* name;
        std::function<void(Plan&)> spoil;
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Bad bad[] = {
        {"speed_mps", [](Plan& p) { p.speed_mps = 0.0; }},
        {"speed_mps", [nan](Plan& p) { p.speed_mps = nan; }},
        {"load_base_N", [](Plan& p) { p.load_base_N = -1.0; }},
        {"load_lift_Ns2pm2", [](Plan& p) { p.load_lift_Ns2pm2 = 20.0; }},
        {"demand_Pa", [](Plan& p) { p.demand_Pa = 0.0; }},
        {"wheel_share", [](Plan& p) { p.wheel_share = -0.1; }},
        {"rolling_radius_m", [](Plan& p) { p.rolling_radius_m = 0.0; }},
        {"coasting_mps", [nan](Plan& p) { p.coasting_mps = nan; }},
        {"mismatch_s", [](Plan& p) { p.mismatch_s = 0.0; }},
        {"settle_s", [nan](Plan& p) { p.settle_s = nan; }},
        {"abort_limit_s", [](Plan& p) { p.abort_limit_s = INFINITY; }},
        {"cool_to_C", [nan](Plan& p) { p.cool_to_C = nan; }},
        {"current profile", [](Plan& p) { p.law = BrakeLaw::open_loop; }},
        {"time_s",
         [](Plan& p) {
             p.law = BrakeLaw::open_loop;
             p.current = {{1.0, 3.0}, {1.0, 4.0}};
         }},
        {"current_mA",
         [](Plan& p) {
             p.law = BrakeLaw::open_loop;
             p.current = {{1.0, -3.0}};
         }},
    };
    for (const Bad& one : bad) {
        Plan plan = landing();
        one.spoil(plan);
        CHECK_THROWS_WITH(Sequencer(plan), ContainsSubstring(one.name));
    }
    CHECK_NOTHROW(Sequencer(landing()));
}
