/// How long the rig waits for a valve command, against the least that SocketCAN takes.
///
/// In turn, equally many exchanges each, in lockstep, by the same client at the same priority on the same
/// processor: from before SYNC is sent, the last frame of a cycle, to the valve command in the client's hands,
/// with the real antiskid-controller on the other side, all frames of a whole recorded stop replayed to it;
/// and from one frame sent to one frame back, with a process on the other side that does nothing else.
/// Both contain one reading of the clock, which is no small thing in a virtual machine.
#pragma once

#include <linux/can.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "firmware/can/layout.hpp"
#include "plant_sim/bench/percentiles.hpp"
#include "plant_sim/stop_options.hpp"

namespace antiskid::bench {

/// What both measurements are told.
struct Settings {
    std::string interface = "vcan0";
    std::filesystem::path controller = BENCH_CONTROLLER;
    std::filesystem::path virtual_rig = BENCH_VIRTUAL_RIG;
    std::filesystem::path json = "out/bench/latency.json";
    int rounds = 6;
    int seconds = 4;    ///< of each wake-up measurement
    int priority = 80;  ///< SCHED_FIFO, of what is measured
    int cpu = 0;        ///< of what is measured

    /// Of the other side of the bus: below what is measured.
    [[nodiscard]] int rig_priority() const { return priority > 10 ? priority - 10 : 0; }
    /// What the started programs print.
    [[nodiscard]] std::filesystem::path log() const { return std::filesystem::path(json).replace_extension(".log"); }
};

/// A whole braking maneuver as the frames of its lockstep run, made in process. Replayed to the real controller
/// it must bring the recorded answers, so whoever measures knows that the controller did its whole work.
struct RecordedStop {
    struct Cycle {
        std::vector<can_frame> sensors;  ///< in the order of the bus
        can_frame sync{};
        can_frame valve{};  ///< the answer
    };
    canid_t valve_id = 0;
    std::vector<Cycle> cycles;
};

[[nodiscard]] RecordedStop record_stop(const plant_sim::StopInputs& scenario);

/// Same identifier, length and payload.
[[nodiscard]] bool same(const can_frame& a, const can_frame& b);

struct CommandRound {
    Percentiles controller;
    Percentiles ping_pong;
    std::uint64_t unlike_recorded = 0;  ///< answers of the controller that are not those of the recorded stop
};

struct CommandLatency {
    std::vector<CommandRound> rounds;
    Percentiles controller;  ///< of all rounds together
    Percentiles ping_pong;
    double clock_reading_us = 0.0;  ///< median
};

/// `on_round` after each. Throws std::runtime_error or std::system_error when a program is missing, fails or
/// does not answer.
[[nodiscard]] CommandLatency measure_command(const Settings& settings, const RecordedStop& stop,
                                             const std::function<void(int, const CommandRound&)>& on_round);

}  // namespace antiskid::bench
