/// What both measurements are told.
#pragma once

#include <filesystem>
#include <string>

namespace antiskid::bench {

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

}  // namespace antiskid::bench
