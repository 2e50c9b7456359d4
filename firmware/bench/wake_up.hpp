/// How late the controller's loop wakes up, against cyclictest in its place.
///
/// In turn, each for the same time, on the same processor, at the same priority and with an interval of 1 ms:
/// antiskid-controller by its timer, by its own histogram; and cyclictest. Both times virtual-rig puts its
/// sensor frames on the bus, by the same clock, 1,000 times a second. It brakes against the controller;
/// against cyclictest, which commands no valve, it stays at its first sample, and its frames go to a socket
/// that nobody reads.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "firmware/bench/percentiles.hpp"
#include "firmware/bench/settings.hpp"
#include "firmware/can/layout.hpp"

namespace antiskid::bench {

struct WakeUpRound {
    Percentiles controller;
    Percentiles cyclictest;
    std::uint64_t frames_received = 0;  ///< by the controller
    std::vector<std::string> faults;    ///< that the controller reported, e.g. overrun on a busy machine
    bool cut_short = false;             ///< virtual-rig gave up, e.g. for such a fault: measured until then
};

/// `on_round` after each. Throws std::runtime_error when a program is missing or fails.
[[nodiscard]] std::vector<WakeUpRound> measure_wake_up(
    const Settings& settings, const can::Layout& layout,
    const std::function<void(int, const WakeUpRound&)>& on_round);

}  // namespace antiskid::bench
