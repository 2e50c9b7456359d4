#include "firmware/can/bus_load.hpp"

#include <algorithm>

#include "firmware/can/schedule.hpp"

namespace antiskid::can {

BusLoad bus_load(const Layout& layout, control::Time step, std::uint32_t bitrate_bps, bool with_sync) {
    const Schedule schedule(layout, step);
    const double step_s = static_cast<double>(step.count()) * 1e-9;
    const double bits_per_step = static_cast<double>(bitrate_bps) * step_s;
    // Ten seconds of steps hold every combination of the periods that occur in practice (at most a second).
    const auto steps = static_cast<std::uint64_t>(std::max(10.0 / step_s, 1.0));
    double sum = 0.0;
    double fullest = 0.0;
    for (std::uint32_t index = 0; index < steps; ++index) {
        double bits = 0.0;
        for (std::size_t i = 0; i < kRoleCount; ++i) {
            const auto role = static_cast<Role>(i);
            const bool sent = schedule.due(role, index) || (role == Role::sync && with_sync && layout[role].bound);
            if (sent) bits += worst_case_bits(layout[role].length);
        }
        sum += bits;
        fullest = std::max(fullest, bits);
    }
    return {.mean = sum / static_cast<double>(steps) / bits_per_step, .peak = fullest / bits_per_step};
}

}  // namespace antiskid::can
