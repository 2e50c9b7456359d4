/// Where in the controller's session a log begins: alive counters and the pace of slow messages give it away.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/can/layout.hpp"

namespace rig::replay {

/// What the controller sent at one recorded step: the counter of each message of it, kNotSent where there was none, kUnknown where
/// nothing is known.
struct SentAtStep {
    static constexpr int kNotSent = -1;
    static constexpr int kUnknown = -2;
    std::array<int, antiskid::can::kRoleCount> counter{};

    SentAtStep() { counter.fill(kUnknown); }
    [[nodiscard]] int& operator[](antiskid::can::Role role) { return counter[static_cast<std::size_t>(role)]; }
    [[nodiscard]] int operator[](antiskid::can::Role role) const { return counter[static_cast<std::size_t>(role)]; }
};

/// The smallest number of steps before the first of `steps` with which counters and schedule agree: 0 for a controller that started
/// with the log. None when no number up to 100 000 does: frames are missing.
[[nodiscard]] std::optional<std::uint64_t> steps_before(const antiskid::can::Layout& layout, antiskid::control::Time period,
                                                        const std::vector<SentAtStep>& steps);

}  // namespace rig::replay
