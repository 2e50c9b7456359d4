// The state machine by itself: self-test, arming, safe, and what lies exactly at a limit.
#include <cmath>

#include "tests/control/bench.hpp"
#include "tests/control/stand.hpp"

using namespace antiskid::control;
using control_test::Bench;
using control_test::fixed_config;
using control_test::kPeriod_s;
using control_test::Stand;

TEST_CASE("self-test needs good inputs, a wheel at rest and no pressure, all at once", "[CTL-070]") {
    Stand s;
    SECTION("passes after its time") {
        CHECK(s.step(49) == State::self_test);
        CHECK(s.step() == State::standby);
    }
    SECTION("speeds unknown") {
        s.estimate.speeds_known = false;
    }
    SECTION("wheel turns") {
        s.move(0.0F, 0.1F);
    }
    SECTION("pressure in the brake") {
        s.sensors.pressure.pressure_Pa = 0.6e6F;
    }
    SECTION("a fault") {
        s.present.insert(Fault::heartbeat_lost);
    }
    if (s.supervisor.state() == State::self_test) {
        CHECK(s.step(1000) == State::self_test);
        CHECK(s.supervisor.latched().empty());
        // Each interruption starts the time anew.
        s.present = {};
        s.estimate.speeds_known = true;
        s.move(0.0F, 0.0F);
        s.sensors.pressure.pressure_Pa = 0.0F;
        CHECK(s.step(30) == State::self_test);
        s.present.insert(Fault::wheel_lost);
        CHECK(s.step() == State::self_test);
        s.present = {};
        CHECK(s.step(49) == State::self_test);
        CHECK(s.step() == State::standby);
    }
}

TEST_CASE("pressure that does not go away fails the self-test, until it has gone", "[CTL-070]") {
    Stand s;
    s.sensors.pressure.pressure_Pa = 1e6F;
    CHECK(s.step(1999) == State::self_test);
    CHECK(s.step() == State::safe);
    CHECK(s.supervisor.latched().contains(Fault::self_test_failed));
    CHECK(s.step(1000) == State::safe);
    s.sensors.pressure.pressure_Pa = 0.0F;
    CHECK(s.step() == State::standby);
    CHECK(s.supervisor.latched().contains(Fault::self_test_failed));
    s.sensors.maneuver.arm = true;
    CHECK(s.step() == State::armed);
    CHECK(s.supervisor.latched().empty());
}

TEST_CASE("arming is an edge", "[CTL-070]") {
    Stand s;
    s.sensors.maneuver.arm = true;  // from the start: a stuck switch, or a controller restarted in the landing
    CHECK(s.step(1000) == State::standby);
    s.sensors.maneuver.arm = false;
    CHECK(s.step() == State::standby);
    s.sensors.maneuver.arm = true;
    CHECK(s.step() == State::armed);
    s.sensors.maneuver.arm = false;
    CHECK(s.step() == State::standby);
}

TEST_CASE("a command that has never come does not arm by coming", "[CTL-070]") {
    Bench b;
    b.v_mps = 0.0;
    b.tamper = [](Sensors& in) { in.maneuver = {}; };
    b.seconds(0.5);
    CHECK(b.command.state == State::self_test);
    b.tamper = nullptr;
    b.sensors.maneuver.arm = true;
    b.seconds(0.5);
    CHECK(b.command.state == State::standby);
}

TEST_CASE("a demand below the threshold is none", "[CTL-073]") {
    Stand s;
    s.to_armed();
    s.sensors.maneuver.demand_Pa = 0.19e6F;
    CHECK(s.step() == State::armed);
    s.sensors.maneuver.demand_Pa = 0.2e6F;
    CHECK(s.step() == State::braking);
    s.sensors.maneuver.demand_Pa = 0.0F;
    CHECK(s.step() == State::armed);
}

TEST_CASE("safe is left by disarming with no cause left, names are cleared by arming again", "[CTL-076]") {
    Stand s;
    s.to_braking();
    s.present.insert(Fault::pressure_range);
    CHECK(s.step() == State::safe);
    s.present = {};
    CHECK(s.step(1000) == State::safe);  // gone, but still armed
    s.present.insert(Fault::wheel_lost);
    s.sensors.maneuver.arm = false;
    CHECK(s.step(1000) == State::safe);  // disarmed, but a cause is there
    CHECK(s.supervisor.latched().contains(Fault::pressure_range));
    CHECK(s.supervisor.latched().contains(Fault::wheel_lost));
    s.present = {};
    CHECK(s.step() == State::standby);
    CHECK(s.step(1000) == State::standby);
    CHECK_FALSE(s.supervisor.latched().empty());
    s.sensors.maneuver.arm = true;
    CHECK(s.step() == State::armed);
    CHECK(s.supervisor.latched().empty());
    CHECK(s.step() == State::braking);
}

TEST_CASE("arming again within the fault gives nothing", "[CTL-076]") {
    Stand s;
    s.to_braking();
    s.present.insert(Fault::bus_off);
    CHECK(s.step() == State::safe);
    for (int i = 0; i < 10; ++i) {
        s.sensors.maneuver.arm = i % 2 == 1;
        CHECK(s.step() == State::safe);
    }
    // Arming in the very period in which the cause goes away: it is a fresh look, but the edge is needed from standby.
    s.sensors.maneuver.arm = true;
    s.present = {};
    CHECK(s.step(10) == State::safe);
}

TEST_CASE("a fault in the period of arming wins", "[CTL-076]") {
    Stand s;
    REQUIRE(s.step(60) == State::standby);
    s.sensors.maneuver.arm = true;
    s.present.insert(Fault::overrun);
    CHECK(s.step() == State::safe);
    CHECK(s.supervisor.latched().contains(Fault::overrun));
}

TEST_CASE("a wheel, a pressure and a speed exactly at their limits", "[CTL-070][CTL-073]") {
    // Shares and a radius whose products with these speeds are exact.
    SupervisorConfig config = fixed_config().supervisor;
    config.lock_share = 0.25F;
    config.unlock_share = 0.75F;
    Stand s;
    s.supervisor = Supervisor(config, kPeriod_s);
    s.estimate.radius_m = 0.5F;
    const auto move = [&s](const float v, const float rim) {
        s.estimate.v_mps = v;
        s.estimate.omega_radps = 2.0F * rim;
    };
    SECTION("at rest is below 0.1 rad/s") {
        s.estimate.omega_radps = 0.1F;
        CHECK(s.step(200) == State::self_test);
        s.estimate.omega_radps = std::nextafter(0.1F, 0.0F);
        CHECK(s.step(50) == State::standby);
    }
    SECTION("no pressure is below the residual one") {
        s.sensors.pressure.pressure_Pa = 0.5e6F;
        CHECK(s.step(200) == State::self_test);
        s.sensors.pressure.pressure_Pa = std::nextafter(0.5e6F, 0.0F);
        CHECK(s.step(50) == State::standby);
    }
    SECTION("spun up is above its speed, a lock below its share, released from its share on") {
        REQUIRE(s.step(60) == State::standby);
        s.sensors.maneuver.arm = true;
        REQUIRE(s.step() == State::armed);
        s.sensors.maneuver.weight_on_wheels = true;
        s.sensors.maneuver.demand_Pa = 10e6F;
        move(40.0F, 30.0F);
        CHECK(s.step(10) == State::touchdown_protection);
        CHECK_FALSE(s.supervisor.rolling());
        move(40.0F, std::nextafter(30.0F, 31.0F));
        CHECK(s.step() == State::braking);
        CHECK(s.supervisor.rolling());
        // A slow wheel's share counts above the drop-out speed.
        s.sensors.maneuver.weight_on_wheels = false;
        s.step();
        s.sensors.maneuver.weight_on_wheels = true;
        move(20.0F, 15.0F);
        CHECK(s.step(10) == State::touchdown_protection);
        move(5.0F, 5.0F);
        CHECK(s.step(10) == State::touchdown_protection);
        move(20.0F, std::nextafter(15.0F, 16.0F));
        CHECK(s.step() == State::braking);
        move(40.0F, 10.0F);
        CHECK(s.step() == State::braking);
        move(40.0F, std::nextafter(10.0F, 0.0F));
        CHECK(s.step() == State::locked_wheel);
        move(40.0F, std::nextafter(30.0F, 0.0F));
        CHECK(s.step() == State::locked_wheel);
        // At the drop-out speed itself a lock is still one.
        move(5.0F, 2.5F);
        CHECK(s.step() == State::locked_wheel);
        move(40.0F, 30.0F);
        CHECK(s.step() == State::braking);
        s.sensors.maneuver.law = Law::deceleration;
        move(std::nextafter(5.0F, 0.0F), 1.0F);
        CHECK(s.step() == State::braking);
        move(5.0F, 1.0F);
        CHECK(s.step() == State::locked_wheel);
    }
}
