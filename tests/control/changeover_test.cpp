// Drop-out and changes of law move the pressure without a jump.
#include "firmware/control/controller.hpp"

#include <algorithm>
#include <cmath>

#include "tests/catch.hpp"
#include "tests/control/bench.hpp"

using namespace antiskid::control;
using control_test::Bench;

TEST_CASE("below drop-out the demand passes through at a limited rate", "[CTL-065]") {
    Bench b;
    b.to_braking();
    b.sensors.maneuver.demand_Pa = 12e6F;
    while (b.v_mps > 4.9) {
        b.v_mps -= 8e-3;
        static_cast<void>(b.step());
    }
    b.steps(20);
    REQUIRE(b.command.state == State::drop_out);
    float before = b.command.pressure_request_Pa;
    CHECK(before < 12e6F);
    int rising = 0;
    for (int i = 0; i < 3000; ++i) {
        const float now = b.step().pressure_request_Pa;
        REQUIRE(now <= 12e6F);
        REQUIRE(now - before <= 10e6F * 1e-3F * 1.001F);
        rising += now > before ? 1 : 0;
        before = now;
    }
    CHECK(before == 12e6F);
    CHECK(rising > 100);
    // The pilot may always have less, at once.
    b.sensors.maneuver.demand_Pa = 2e6F;
    CHECK(b.step().pressure_request_Pa == 2e6F);
    b.sensors.maneuver.demand_Pa = 12e6F;
    CHECK(b.step().pressure_request_Pa == Approx(2e6 + 10e3));
    CHECK(b.command.slip_reference == 0.0F);
}

TEST_CASE("pass-through starts from the pressure that is there", "[CTL-065]") {
    Bench b;
    b.to_braking(Law::wheel_slip);
    b.sensors.maneuver.demand_Pa = 12e6F;
    while (b.v_mps > 5.001) {
        b.v_mps = std::max(5.001, b.v_mps - 8e-3);
        static_cast<void>(b.step());
    }
    REQUIRE(b.command.state == State::braking);
    b.v_mps = 4.9;
    while (b.command.state != State::drop_out) {
        b.v_mps -= 1e-4;
        static_cast<void>(b.step());
    }
    CHECK(static_cast<double>(b.command.pressure_request_Pa) == Approx(b.valve_Pa()).margin(0.15e6));
}

TEST_CASE("changing the law does not jump", "[CTL-065]") {
    // A quiet wheel at its reference under 6 MPa; the law changes in mid-braking, each into each.
    const auto from = static_cast<Law>(GENERATE(range(0, int{kLawCount})));
    const auto to = static_cast<Law>(GENERATE(range(0, int{kLawCount})));
    Bench b;
    b.to_braking(Law::open_loop);
    b.sensors.maneuver.demand_Pa = 20e6F;
    b.sensors.maneuver.current_mA = valve_current_mA(b.config.valve, 6e6F);
    b.sensors.maneuver.deceleration_mps2 = 0.0F;
    b.seconds(0.5);
    const auto change = [&b](const Law law) {
        b.sensors.maneuver.law = law;
        const float before = b.command.pressure_request_Pa;
        const float now = b.step().pressure_request_Pa;
        // One period's worth of the quickest ramp (the build-up's 1 MPa), less than the valve's noise afterwards.
        return std::abs(now - before);
    };
    CHECK(change(from) <= 1.2e6F);
    b.steps(3);
    b.sensors.maneuver.current_mA = valve_current_mA(b.config.valve, b.command.pressure_request_Pa);
    CAPTURE(static_cast<int>(from), static_cast<int>(to), b.command.pressure_request_Pa);
    CHECK(change(to) <= 1.2e6F);
}

TEST_CASE("a law that takes over is held back at the rate of a demand that passes through, and no longer", "[CTL-065]") {
    Bench b;
    b.to_braking(Law::open_loop);
    b.sensors.maneuver.demand_Pa = 20e6F;
    b.sensors.maneuver.current_mA = valve_current_mA(b.config.valve, 2e6F);
    b.seconds(0.3);
    const float before = b.command.pressure_request_Pa;
    REQUIRE(before == Approx(2e6F));
    // The wheel slips less than the threshold law allows: it would rise by 64 MPa/s.
    b.sensors.maneuver.law = Law::threshold;
    b.slip = 0.05;
    for (int k = 1; k <= 200; ++k) {
        const auto max = static_cast<double>(before) + 10e3 * k;
        REQUIRE(static_cast<double>(b.step().pressure_request_Pa) == Approx(max).epsilon(1e-3));
    }
    // What braked before does not hold back what brakes anew.
    b.sensors.maneuver.demand_Pa = 0.0F;
    b.steps(2);
    REQUIRE(b.command.state == State::armed);
    b.sensors.maneuver.demand_Pa = 20e6F;
    b.steps(150);
    CHECK(b.command.pressure_request_Pa > 8e6F);
}

TEST_CASE("from a reading below none the demand passes through from none", "[CTL-065]") {
    Bench b;
    b.to_braking();
    b.sensors.maneuver.demand_Pa = 0.3e6F;
    b.tamper = [](Sensors& seen) { seen.pressure.pressure_Pa = -0.4e6F; };
    while (b.command.state == State::braking) {
        b.v_mps -= 8e-3;
        static_cast<void>(b.step());
    }
    REQUIRE(b.command.state == State::drop_out);
    CHECK(b.command.pressure_request_Pa == 0.0F);
    CHECK(b.command.current_mA == b.config.valve.safe_current_mA);
}
