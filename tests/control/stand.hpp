/// The state machine by itself on a bench: what it is told is set by hand.
#pragma once

#include "firmware/control/supervisor.hpp"
#include "tests/catch.hpp"
#include "tests/control/fixed_config.hpp"

namespace control_test {

namespace control = antiskid::control;

inline constexpr float kRadius_m = 0.32F;

/// One supervisor and its inputs.
struct Stand {
    Stand() {
        sensors.maneuver.received = control::Time{0};
        sensors.maneuver.law = control::Law::wheel_slip;
        estimate.speeds_known = true;
        estimate.radius_m = kRadius_m;
        move(0.0F, 0.0F);
    }
    void move(const float v, const float rim) {
        estimate.v_mps = v;
        estimate.omega_radps = rim / kRadius_m;
    }
    control::State step(const int count = 1) {
        for (int i = 0; i < count; ++i) supervisor.update(sensors, estimate, present, control::Time{});
        return supervisor.state();
    }
    /// Through the self-test, armed, landed at 50 m/s and rolling.
    void to_armed() {
        REQUIRE(step(60) == control::State::standby);
        sensors.maneuver.arm = true;
        REQUIRE(step() == control::State::armed);
        sensors.maneuver.weight_on_wheels = true;
        move(50.0F, 50.0F);
        REQUIRE(step() == control::State::armed);
    }
    void to_braking() {
        to_armed();
        sensors.maneuver.demand_Pa = 10e6F;
        REQUIRE(step() == control::State::braking);
    }

    control::Supervisor supervisor{fixed_config().supervisor, kPeriod_s};
    control::Sensors sensors;
    control::Estimate estimate;
    control::FaultSet present;
};

}  // namespace control_test
