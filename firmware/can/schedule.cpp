#include "firmware/can/schedule.hpp"

#include <algorithm>

namespace antiskid::can {

namespace {

/// Where in its cycle a slow message starts, in steps; a 20 ms, three 10 ms and three 100 ms messages then never
/// meet at 1 ms steps.
std::uint32_t first_step(Role role) {
    switch (role) {
        case Role::load_cells:
            return 2;
        case Role::status:
            return 4;
        case Role::maneuver_state:
            return 5;
        case Role::faults:
            return 6;
        case Role::road:
            return 7;
        case Role::rig_heartbeat:
            return 8;
        case Role::controller_heartbeat:
            return 9;
        default:
            return 0;
    }
}

}  // namespace

Schedule::Schedule(const Layout& layout, control::Time step) {
    for (std::size_t i = 0; i < kRoleCount; ++i) {
        const Message& message = layout.messages[i];
        if (!message.bound || message.period.count() <= 0) continue;
        const auto every = static_cast<std::uint32_t>(std::max<std::int64_t>(message.period / step, 1));
        slots_[i] = {.every = every, .phase = first_step(static_cast<Role>(i)) % every};
    }
}

}  // namespace antiskid::can
