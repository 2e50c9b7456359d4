/// What the tests of the ports send, and the counts of what was taken.
#pragma once

#include "firmware/can/controller_port.hpp"
#include "firmware/can/rig_port.hpp"

namespace pohost_test {

using namespace antiskid;
using namespace antiskid::can;
using control::Time;

inline constexpr Time kStep{1'000'000};

inline RigSample some_sample() {
    RigSample sample;
    sample.wheel = {.edge_count = 10, .edge_time = Time{5'000'000}, .speed_radps = 150.0F};
    sample.flywheel = {.edge_count = 20, .edge_time = Time{6'000'000}, .speed_radps = 160.0F};
    sample.pressure_Pa = 5.5e6F;
    sample.maneuver = {.law = control::Law::threshold,
                       .arm = true,
                       .weight_on_wheels = true,
                       .demand_Pa = 2e7F,
                       .slip_reference = 0.25F,
                       .deceleration_mps2 = 3.2F,
                       .current_mA = 17.0F};
    return sample;
}

inline std::uint32_t accepted(const ControllerPort& port) {
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < kRoleCount; ++i) sum += port.stats(static_cast<Role>(i)).accepted;
    return sum;
}

inline std::uint32_t rejected(const ControllerPort& port) {
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < kRoleCount; ++i) sum += port.stats(static_cast<Role>(i)).rejected();
    return sum;
}

}  // namespace pohost_test
