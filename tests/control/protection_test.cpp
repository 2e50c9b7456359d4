// What the state machine keeps away from the law: touchdown, locks, low speed.
#include "tests/control/stand.hpp"

using namespace antiskid::control;
using control_test::Stand;

TEST_CASE("touchdown protection ends with the wheel spun up or with its time", "[CTL-073]") {
    Stand s;
    REQUIRE(s.step(60) == State::standby);
    s.sensors.maneuver.arm = true;
    s.sensors.maneuver.demand_Pa = 20e6F;  // a pilot already on the pedals
    s.move(60.0F, 0.0F);
    CHECK(s.step(5000) == State::armed);  // in the air, for as long as it takes
    s.sensors.maneuver.weight_on_wheels = true;
    SECTION("spun up") {
        s.move(60.0F, 30.0F);
        CHECK(s.step(100) == State::touchdown_protection);
        s.move(60.0F, 30.1F);
        CHECK(s.step() == State::braking);
        // Once over it stays over, also for a slower wheel.
        s.move(25.0F, 22.0F);
        CHECK(s.step() == State::braking);
    }
    SECTION("a slow wheel that turns along") {
        s.move(25.0F, 17.4F);
        CHECK(s.step(100) == State::touchdown_protection);
        s.move(25.0F, 17.6F);
        CHECK(s.step() == State::braking);
    }
    SECTION("time") {
        s.move(25.0F, 17.0F);
        CHECK(s.step(2999) == State::touchdown_protection);
        CHECK(s.step() == State::braking);
    }
    SECTION("time, and a wheel that never turned, is a locked wheel") {
        CHECK(s.step(2999) == State::touchdown_protection);
        CHECK(s.step() == State::locked_wheel);
    }
    CHECK(s.supervisor.latched().empty());
}

TEST_CASE("a controller that starts on its wheels has not seen them spin up", "[CTL-073]") {
    Stand s;
    s.sensors.maneuver.weight_on_wheels = true;
    CHECK_FALSE(s.supervisor.rolling());
    REQUIRE(s.step(60) == State::standby);
    CHECK_FALSE(s.supervisor.rolling());
    s.sensors.maneuver.arm = true;
    s.sensors.maneuver.demand_Pa = 10e6F;
    s.move(25.0F, 17.0F);
    CHECK(s.step() == State::armed);
    CHECK(s.step() == State::touchdown_protection);
    CHECK_FALSE(s.supervisor.rolling());
    CHECK(s.step(3000) == State::braking);
    CHECK(s.supervisor.rolling());  // it should by now
}

TEST_CASE("a bounce is no fault and protects again", "[CTL-073]") {
    Stand s;
    s.to_braking();
    CHECK(s.supervisor.rolling());
    s.sensors.maneuver.weight_on_wheels = false;
    CHECK(s.step() == State::armed);
    CHECK_FALSE(s.supervisor.rolling());
    s.move(50.0F, 0.0F);  // the wheel stops in the air
    CHECK(s.step(700) == State::armed);
    s.sensors.maneuver.weight_on_wheels = true;
    CHECK(s.step(20) == State::touchdown_protection);
    s.move(50.0F, 35.0F);
    CHECK(s.step() == State::braking);
    // The time starts anew with each contact.
    s.sensors.maneuver.weight_on_wheels = false;
    s.step();
    s.move(28.0F, 19.0F);
    s.sensors.maneuver.weight_on_wheels = true;
    CHECK(s.step(2999) == State::touchdown_protection);
    CHECK(s.step() == State::braking);
    CHECK(s.supervisor.latched().empty());
}

TEST_CASE("a squat switch that opens for a moment, or a command of the approach in between, costs that moment", "[CTL-073]") {
    const float v = GENERATE(5.1F, 12.0F, 29.0F, 45.0F);
    const bool approach = GENERATE(false, true);  // its command disarms, too
    Stand s;
    s.to_braking();
    s.move(v, 0.8F * v);
    s.sensors.maneuver.weight_on_wheels = false;
    s.sensors.maneuver.arm = !approach;
    CHECK(s.step(20) == (approach ? State::standby : State::armed));
    s.sensors.maneuver.weight_on_wheels = s.sensors.maneuver.arm = true;
    if (approach) CHECK(s.step() == State::armed);
    CHECK(s.step() == State::braking);
}

TEST_CASE("a wheel below 30 % is released until 70 %", "[CTL-073]") {
    const auto law = GENERATE(Law::wheel_slip, Law::deceleration, Law::threshold, Law::pressure_bias, Law::peak_slip);
    Stand s;
    s.to_braking();
    s.sensors.maneuver.law = law;
    s.move(50.0F, 15.1F);
    CHECK(s.step() == State::braking);
    s.move(50.0F, 14.9F);
    CHECK(s.step() == State::locked_wheel);
    s.move(50.0F, 34.9F);
    CHECK(s.step(500) == State::locked_wheel);
    s.move(50.0F, 35.1F);
    CHECK(s.step() == State::braking);
    s.move(50.0F, 20.0F);
    CHECK(s.step() == State::braking);
}

TEST_CASE("a wheel that does not come back when it must is a fault, one that does is none, however often", "[CTL-073]") {
    struct Row {
        float v_mps;
        int periods;  // the last without a fault: 125 ms, and 0.7 v at 50 m/s2
    };
    const Row row = GENERATE(Row{60.0F, 965}, Row{50.0F, 825}, Row{20.0F, 405}, Row{10.0F, 265}, Row{7.0F, 223});
    CAPTURE(row.v_mps);
    Stand s;
    s.to_braking();
    s.sensors.maneuver.law = GENERATE(Law::threshold, Law::pressure_bias, Law::deceleration);
    for (int i = 0; i < 20; ++i) {
        s.move(row.v_mps, 0.1F * row.v_mps);
        CHECK(s.step(row.periods - 1) == State::locked_wheel);
        s.move(row.v_mps, 0.8F * row.v_mps);
        CHECK(s.step() == State::braking);
    }
    s.move(row.v_mps, 0.1F * row.v_mps);
    CHECK(s.step(row.periods - 1) == State::locked_wheel);
    CHECK(s.step(3) == State::safe);
    CHECK(s.supervisor.latched().contains(Fault::lock_persists));
    s.sensors.maneuver.arm = false;
    CHECK(s.step() == State::standby);
}

TEST_CASE("under a law that holds a slip, locks that recur are a fault, although none lasts", "[CTL-073]") {
    Stand s;
    s.to_braking();
    s.sensors.maneuver.law = GENERATE(Law::wheel_slip, Law::peak_slip);
    const auto cycle = [&s](const int locked, const int rolling) {
        s.move(50.0F, 5.0F);
        if (s.step(locked) == State::safe) return true;
        s.move(50.0F, 40.0F);
        return s.step(rolling) == State::safe;
    };
    SECTION("a quarter of the time is ridden out for ever") {
        for (int i = 0; i < 1000; ++i) REQUIRE_FALSE(cycle(20, 61));
    }
    SECTION("half of the time is two thirds of what lasts, each time") {
        int cycles = 1;
        while (!cycle(30, 30)) REQUIRE(++cycles < 100);
        CHECK(cycles == 41);  // 40 x (30 - 10) ms, and 25 of 825
        CHECK(s.supervisor.latched().contains(Fault::lock_persists));
    }
}

TEST_CASE("open loop has no lock protection and no drop-out", "[CTL-073]") {
    Stand s;
    s.to_braking();
    s.sensors.maneuver.law = Law::open_loop;
    s.move(50.0F, 0.0F);
    CHECK(s.step(3000) == State::braking);
    s.move(1.0F, 1.0F);
    CHECK(s.step() == State::braking);
}

TEST_CASE("anti-skid drops out below 5 m/s and comes back above 6", "[CTL-073]") {
    const auto law = GENERATE(Law::wheel_slip, Law::threshold, Law::pressure_bias, Law::peak_slip);
    Stand s;
    s.to_braking();
    s.sensors.maneuver.law = law;
    s.move(5.0F, 5.0F);
    CHECK(s.step() == State::braking);
    s.move(4.99F, 0.0F);
    CHECK(s.step() == State::drop_out);
    s.move(5.99F, 5.0F);
    CHECK(s.step() == State::drop_out);
    s.move(6.0F, 5.0F);
    CHECK(s.step() == State::braking);
    s.move(4.0F, 4.0F);
    CHECK(s.step() == State::drop_out);
    s.move(6.5F, 0.5F);
    CHECK(s.step() == State::locked_wheel);
    s.move(4.0F, 0.0F);
    CHECK(s.step(3000) == State::drop_out);
}

TEST_CASE("the deceleration law brakes to standstill", "[CTL-073]") {
    Stand s;
    s.to_braking();
    s.sensors.maneuver.law = Law::deceleration;
    for (const float v : {4.9F, 2.0F, 0.0F}) {
        s.move(v, 0.0F);
        CHECK(s.step() == State::braking);
    }
}
