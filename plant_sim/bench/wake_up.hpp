/// How late the controller's loop wakes up, against cyclictest in its place; and how old the newest wheel frame is when the
/// command that answers it leaves, by the sensors' frame and by the timer.
///
/// In turn, each for the same time, on the same processor, at the same priority and with an interval of 1 ms:
/// antiskid-controller by its timer and by the sensors' frame, by its own histograms; and cyclictest. Each time virtual-rig puts its
/// sensor frames on the bus, by the same clock, 1,000 times a second. It brakes against the controller;
/// against cyclictest, which commands no valve, it stays at its first sample, and its frames go to a socket
/// that nobody reads.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "firmware/can/layout.hpp"
#include "plant_sim/bench/percentiles.hpp"
#include "plant_sim/bench/settings.hpp"

namespace antiskid::bench {

struct WakeUpRound {
    Percentiles controller;
    Percentiles cyclictest;
    Percentiles edge_by_sensors;  ///< from the reception of the newest wheel frame to the command on its way
    Percentiles edge_by_timer;
    std::uint64_t frames_received = 0;  ///< by the controller, by its timer
    std::vector<std::string> faults;    ///< that the controller reported, e.g. overrun on a busy machine
    bool cut_short = false;             ///< virtual-rig gave up, e.g. for such a fault: measured until then
};

/// `on_round` after each. Throws std::runtime_error when a program is missing or fails.
[[nodiscard]] std::vector<WakeUpRound> measure_wake_up(const Settings& settings, const can::Layout& layout,
                                                       const std::function<void(int, const WakeUpRound&)>& on_round);

}  // namespace antiskid::bench
