// What a landing leaves behind in the controller, and what the next one does not find.
#include "firmware/control/controller.hpp"

#include <algorithm>

#include "tests/catch.hpp"
#include "tests/control/bench.hpp"

using namespace antiskid::control;
using control_test::Bench;
using control_test::fixed_config;

namespace {

/// The most that the law's reference comes to within the next 30 periods.
float max_reference(Bench& b) {
    float max = 0.0F;
    for (int i = 0; i < 30; ++i) max = std::max(max, b.step().slip_reference);
    return max;
}

void slip_to(Bench& b, const double slip) {
    while (b.slip != slip) {
        b.slip += std::clamp(slip - b.slip, -0.01, 0.01);
        b.steps(1);
    }
}

/// Braking at a reference of 0.2 that has retreated: the wheel has slipped by 0.65 for 100 ms.
void to_retreated(Bench& b) {
    b.to_braking();
    b.sensors.maneuver.slip_reference = 0.2F;
    REQUIRE(max_reference(b) == Approx(0.2));
    slip_to(b, 0.65);
    b.seconds(0.1);
    REQUIRE(b.command.state == State::braking);
    slip_to(b, 0.07);
    REQUIRE(max_reference(b) < 0.15F);
}

}  // namespace

TEST_CASE("a reference that has retreated is whole on the next landing", "[CTL-040]") {
    const bool from_touchdown = GENERATE(false, true);
    CAPTURE(from_touchdown);
    Bench b;
    to_retreated(b);
    b.sensors.maneuver.demand_Pa = 0.0F;
    b.seconds(0.2);
    b.sensors.maneuver.arm = false;
    b.sensors.maneuver.weight_on_wheels = false;
    REQUIRE(b.step().state == State::standby);
    b.slip = 1.0;
    b.seconds(0.3);
    b.sensors.maneuver.arm = true;
    REQUIRE(b.step().state == State::armed);
    b.sensors.maneuver.weight_on_wheels = true;
    if (from_touchdown) {
        b.sensors.maneuver.demand_Pa = 6e6F;
        REQUIRE(b.step().state == State::touchdown_protection);
        b.spin_up();
        b.slip = 0.07;
    } else {
        b.spin_up();
        b.slip = 0.07;
        b.seconds(0.3);
        REQUIRE(b.command.state == State::armed);
        b.sensors.maneuver.demand_Pa = 6e6F;
    }
    CHECK(max_reference(b) == Approx(0.2));
    CHECK(b.command.state == State::braking);
}

TEST_CASE("a reference that has retreated stays so within a landing", "[CTL-040]") {
    Bench b;
    to_retreated(b);
    SECTION("after a lock") {
        slip_to(b, 0.9);
        REQUIRE(b.command.state == State::locked_wheel);
        slip_to(b, 0.07);
    }
    SECTION("after the demand was taken back") {
        b.sensors.maneuver.demand_Pa = 0.0F;
        b.seconds(0.2);
        REQUIRE(b.command.state == State::armed);
        b.sensors.maneuver.demand_Pa = 6e6F;
        b.steps(1);
    }
    SECTION("after another law") {
        b.sensors.maneuver.law = Law::threshold;
        b.seconds(0.1);
        b.sensors.maneuver.law = Law::wheel_slip;
        b.steps(1);
    }
    REQUIRE(b.command.state == State::braking);
    CHECK(max_reference(b) < 0.15F);
}

TEST_CASE("the slip of most friction is sought from its start on each landing and after a lock, and told", "[CTL-340]") {
    Config config = fixed_config();
    config.peak.swing = 0.0F;
    config.peak.elasticity = -1.0F;  // always upwards
    Bench b(config);
    const auto land = [&b] {
        float first = 0.0F;
        b.sensors.maneuver.arm = true;
        b.sensors.maneuver.weight_on_wheels = true;
        b.spin_up();
        b.slip = 0.07;
        b.seconds(0.3);
        b.sensors.maneuver.demand_Pa = 6e6F;
        for (int i = 0; i < 40; ++i) first = b.step().slip_reference;
        return first;
    };
    b.to_standby();
    b.sensors.maneuver.law = Law::peak_slip;
    const float begins = land();
    CHECK(begins == Approx(0.16).epsilon(0.2));
    b.seconds(1.0);
    REQUIRE(b.command.state == State::braking);
    CHECK(b.command.slip_reference == 0.4F);
    SECTION("not on the same landing") {
        b.sensors.maneuver.demand_Pa = 0.0F;
        b.seconds(0.2);
        REQUIRE(b.command.state == State::armed);
        b.sensors.maneuver.demand_Pa = 6e6F;
        b.steps(40);
        CHECK(b.command.slip_reference == 0.4F);
    }
    SECTION("after a lock") {
        slip_to(b, 0.9);
        REQUIRE(b.command.state == State::locked_wheel);
        slip_to(b, 0.07);
        b.steps(40);
        REQUIRE(b.command.state == State::braking);
        CHECK(b.command.slip_reference < 0.25F);  // from its start 70 ms take it to 0.23 at the most
        CHECK(b.command.slip_reference > 0.15F);
    }
    SECTION("on the next one") {
        b.sensors.maneuver.demand_Pa = 0.0F;
        b.seconds(0.2);
        b.sensors.maneuver.arm = false;
        b.sensors.maneuver.weight_on_wheels = false;
        b.slip = 1.0;
        b.seconds(0.3);
        REQUIRE(b.command.state == State::standby);
        CHECK(land() == Approx(begins).epsilon(0.02));
    }
}

TEST_CASE("the bias outlasts a lock, neither another law nor a landing", "[CTL-330]") {
    Config config = fixed_config();
    config.pressure_bias.max_bias_share = 1.0F;
    Bench b(config);
    b.to_braking(Law::pressure_bias);
    b.sensors.maneuver.demand_Pa = 20e6F;
    slip_to(b, 0.3);
    b.seconds(0.05);
    slip_to(b, 0.07);
    const float biased_Pa = b.command.pressure_request_Pa;
    slip_to(b, 0.9);
    REQUIRE(b.command.state == State::locked_wheel);
    REQUIRE(b.command.pressure_request_Pa == 0.0F);
    const auto come_back = [&b] {
        while (b.command.state == State::locked_wheel) slip_to(b, b.slip - 0.01);
        REQUIRE(b.command.state == State::braking);
        return b.command.pressure_request_Pa;
    };
    SECTION("back with the same law") {
        const float back_Pa = come_back();
        CHECK(back_Pa < biased_Pa);
        CHECK(back_Pa > 3e6F);
        CHECK(b.step().pressure_request_Pa == Approx(back_Pa + 4e3F));
    }
    SECTION("another law in between: from the present pressure") {
        b.sensors.maneuver.law = Law::threshold;
        static_cast<void>(come_back());
        slip_to(b, 0.9);
        REQUIRE(b.command.state == State::locked_wheel);
        b.sensors.maneuver.law = Law::pressure_bias;
        CHECK(come_back() == Approx(64e3).margin(30e3));
    }
    SECTION("on the next landing the wheel is locked from the first: from the present pressure, slowly") {
        b.sensors.maneuver.arm = false;
        b.sensors.maneuver.demand_Pa = 0.0F;
        slip_to(b, 0.07);
        REQUIRE(b.command.state == State::standby);
        b.sensors.maneuver.arm = true;
        b.steps(2);
        REQUIRE(b.command.state == State::armed);
        slip_to(b, 0.9);
        b.sensors.maneuver.demand_Pa = 20e6F;
        b.steps(2);
        REQUIRE(b.command.state == State::locked_wheel);
        CHECK(come_back() == Approx(4e3).margin(30e3));
    }
}
