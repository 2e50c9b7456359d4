/// Many maneuvers on one rig: each like the first but for the brake that remembers; cool-down at once.
#include <limits>

#include "tests/catch.hpp"
#include "tests/plc/operator.hpp"

using plc::Bench;
using plc_test::maneuver;
using plc_test::Operator;

TEST_CASE("several maneuvers one after the other: books closed, energy counted on", "[RIG-230]") {
    Operator op(Bench::endurance);
    double before_J = 0.0;
    for (int i = 0; i < 4; ++i) {
        CAPTURE(i);
        REQUIRE(maneuver(op, 40.0, 18.0));
        CHECK(op.rig.maneuvers() == static_cast<std::uint32_t>(i + 1));
        // Rim and wheel have come from 40 m/s to rest; a share of a percent went into the tyre and the air.
        const double stop_J = op.rig.cumulative_energy_J() - before_J;
        const double kinetic_J = 0.5 * op.plant.rig.wheel.mass_kg * 40.0 * 40.0;
        CHECK(stop_J < kinetic_J);
        CHECK(stop_J > 0.93 * kinetic_J);
        before_J = op.rig.cumulative_energy_J();
        const plant::Rig& rig = op.rig.rig();
        const double residual =
            rig.kinetic_energy_J() + rig.wheel().energy_brake_J + rig.wheel().energy_tyre_J + rig.energy_drag_J() - rig.energy_drive_J();
        CHECK(std::abs(residual) < 1e-6 * rig.energy_drive_J());
    }
}

TEST_CASE("eq. (7) finds the friction that the brake had, on a rig that has braked before", "[RIG-230]") {
    plc::ServedRigOptions options = plc::load_served_rig("config", Bench::endurance);
    options.brake.emplace(plc_test::loaded(Bench::endurance).wear, wear::ConditionalRule{}, wear::BrakeState{});
    Operator op(Bench::endurance, options, 1);
    for (const double taken_J : {10e6, 480e6}) {
        op.rig.set_brake_state({.seed = 1, .maneuvers = 0, .c_e_J = taken_J});
        const double given = op.rig.brake()->next_friction();
        CHECK((taken_J < 100e6) == (given > 0.25));
        op.wish({.drive = true, .speed_mps = 55.0});
        REQUIRE(op.until([&op] { return op.v() > 54.95; }, 60.0));
        op.wish({.advance = true, .load = true});
        REQUIRE(op.until([&op] { return op.rig.wheel_on_rim(); }, 10.0));
        op.run(2.0);
        const double brake_on_mps = op.v();
        double torque = 0.0;
        double pressure = 0.0;
        double expected = 0.0;
        while (!op.rig.rig().standstill()) {
            const double x = op.v() / brake_on_mps;
            op.tick(18.0);
            const double p = op.rig.rig().pressure_Pa();
            torque += op.rig.rig().forces().brake_torque_Nm;
            pressure += p;
            // The light curve of flywheel_rig.toml, shifted to the given mean.
            expected += p * (given + 0.30 * (0.10 - 0.16 * x - 0.06 * x * x));
        }
        const double found = torque / pressure / op.plant.rig.brake.gain_m3();
        CHECK(found == Approx(expected / pressure).epsilon(1e-3));
        CHECK(found == Approx(given).epsilon(0.02));  // a stop at constant pressure is a little longer at its end
        op.wish({});
        REQUIRE(op.until([&op] { return op.rig.idle(); }, 30.0));
    }
}

TEST_CASE("an aborted maneuver leaves a rig that runs the next", "[RIG-230]") {
    Operator op(Bench::landing);
    op.wish({.drive = true, .speed_mps = 30.0});
    REQUIRE(op.until([&op] { return op.v() > 29.9; }, 60.0));
    op.wish({.advance = true, .load = true});
    REQUIRE(op.until([&op] { return op.rig.wheel_on_rim(); }, 10.0));
    op.run(3.0);
    op.wish({});
    op.run(4.0);
    CHECK(op.rig.sledge_m() == 0.0);
    CHECK(op.rig.rig().wheel().omega_radps > 10.0);  // the free wheel turns on
    CHECK_FALSE(op.rig.idle());
    REQUIRE(op.until([&op] { return op.rig.idle(); }, 120.0));  // until its own drag has stopped it
    CHECK(op.v() > 20.0);
    CHECK(maneuver(op, 40.0, 14.0));
}

TEST_CASE("cool-down at once is cool-down step by step", "[RIG-230]") {
    Operator jump(Bench::endurance);
    REQUIRE(maneuver(jump, 40.0, 18.0));
    Operator steps(Bench::endurance);
    REQUIRE(maneuver(steps, 40.0, 18.0));
    const double hot_C = jump.rig.brake_temperature_C();
    CHECK(hot_C > 100.0);
    CHECK(jump.rig.pass_idle(60.0) == Approx(60.0));
    steps.run(60.0);
    CHECK(jump.rig.time_s() == steps.rig.time_s());
    CHECK(jump.rig.brake_temperature_C() == Approx(steps.rig.brake_temperature_C()).epsilon(1e-9));
    CHECK(jump.rig.brake_temperature_C() < hot_C - 5.0);
    CHECK(jump.v() == Approx(steps.v()).margin(1e-6));
    CHECK(jump.measured(plc_test::Measured::plc_watchdog) == Approx(steps.measured(plc_test::Measured::plc_watchdog)).margin(1.0));
    // The bridge was alive: no trip, and it goes on.
    jump.run(1.0);
    CHECK(jump.measured(plc_test::Measured::plc_state) == 0.0);
    const double left_s = jump.rig.cooling_time_s(60.0);
    CHECK(jump.rig.pass_idle(left_s) == Approx(left_s).margin(1e-3));
    CHECK(jump.rig.brake_temperature_C() == Approx(60.0).margin(1e-3));
    CHECK(maneuver(jump, 40.0, 18.0));
}

TEST_CASE("no time passes at once on a rig that is not idle", "[RIG-230]") {
    Operator op(Bench::endurance);
    op.wish({.drive = true, .speed_mps = 10.0});
    op.run(1.0);
    const double before_s = op.rig.time_s();
    CHECK(op.rig.pass_idle(10.0) == 0.0);
    op.wish({.advance = true});
    op.run(1.0);
    CHECK(op.rig.pass_idle(10.0) == 0.0);
    CHECK(op.rig.time_s() == Approx(before_s + 1.0));
    for (const double nonsense : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        Operator idle(Bench::endurance);
        CHECK(idle.rig.pass_idle(nonsense) == 0.0);
    }
}
