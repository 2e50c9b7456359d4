/// Time until the rig gets a valve command, compared with the shortest time of SocketCAN.
///
/// Both are measured alternately with the same number of exchanges, in lockstep, by the same client with the same priority on the same processor. The
/// first is from before SYNC, the last frame of a cycle, is sent until the client has the valve command; on the other side is the real
/// antiskid-controller, which gets all frames of a recorded stop. The second is from one frame sent to one frame back, with a process on the other
/// side that does nothing else. Both contain one reading of the clock, which takes long in a virtual machine.
#pragma once

#include <linux/can.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "firmware/can/layout.hpp"
#include "plant_sim/bench/percentiles.hpp"
#include "plant_sim/scenario/stop_options.hpp"

namespace antiskid::bench {

/// Settings of both measurements.
struct Settings {
    std::string interface = "vcan0";
    std::filesystem::path controller = BENCH_CONTROLLER;
    std::filesystem::path virtual_rig = BENCH_VIRTUAL_RIG;
    std::filesystem::path json = "out/bench/latency.json";
    int rounds = 6;
    int seconds = 4;    ///< of each wake-up measurement
    int priority = 80;  ///< SCHED_FIFO, of the measured program
    int cpu = 0;        ///< of the measured program

    /// Priority of the program on the other side of the bus: below that of the measured one.
    [[nodiscard]] int rig_priority() const { return priority > 10 ? priority - 10 : 0; }
    /// File for the output of the started programs.
    [[nodiscard]] std::filesystem::path log() const { return std::filesystem::path(json).replace_extension(".log"); }
};

/// A complete braking maneuver as the frames of its lockstep run, made in process. The real controller must answer with the recorded answers; this
/// shows that it does all of its work.
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

/// Whether identifier, length and payload are equal.
[[nodiscard]] bool same(const can_frame& a, const can_frame& b);

struct CommandRound {
    Percentiles controller;
    Percentiles ping_pong;
    std::uint64_t unlike_recorded = 0;  ///< number of the controller's answers that differ from the recorded stop
};

struct CommandLatency {
    std::vector<CommandRound> rounds;
    Percentiles controller;  ///< over all rounds
    Percentiles ping_pong;
    double clock_reading_us = 0.0;  ///< median
};

/// Calls `on_round` after each round. Throws std::runtime_error or std::system_error if a program is missing, fails or does not answer.
[[nodiscard]] CommandLatency measure_command(const Settings& settings, const RecordedStop& stop,
                                             const std::function<void(int, const CommandRound&)>& on_round);

}  // namespace antiskid::bench
