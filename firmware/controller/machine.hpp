/// What the computer must be for a steady period and a whole record: what it is (facts), and whether that will do (checks). The facts are
/// the door: machine_facts() reads them from this machine, tests write them down.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/controller/check.hpp"

namespace antiskid::controller {

struct MachineNeeds {
    std::string program;                 ///< name of the executable, for remedies
    int priority = 0;                    ///< SCHED_FIFO 1 to 99; 0: ordinary scheduling
    std::optional<int> cpu;              ///< that the loop is pinned to
    std::filesystem::path record = ".";  ///< where the record, report or ledger goes; need not be there yet
    double record_bytes = 1e9;           ///< free space that it needs
};

struct MachineFacts {
    std::string kernel;            ///< uname -v: "#1 SMP PREEMPT_RT Debian ..."
    bool realtime_kernel = false;  ///< /sys/kernel/realtime
    bool fifo_granted = false;     ///< SCHED_FIFO at the wanted priority
    std::uint64_t rtprio_limit = 0;
    bool memory_locked = false;
    bool pinned = false;  ///< the wanted processor is there and allowed
    struct Governor {
        int cpu = 0;
        std::string name;
    };
    std::vector<Governor> governors;  ///< of the loop's processor, or of all; empty: the kernel scales no frequency
    std::string isolated;             ///< as isolcpus= has them: "2-3,5"
    std::string clock_source;         ///< "tsc", "hpet", ...
    double clock_resolution_s = 0.0;  ///< CLOCK_MONOTONIC
    bool clock_synchronised = false;  ///< the wall clock, as adjtimex(2) has it
    double record_free_bytes = 0.0;
    std::string record_rejection;  ///< why nothing can be written there; empty: it can
};

/// `root`: where proc and sys are. Locks this process's memory, as the loop will.
[[nodiscard]] MachineFacts machine_facts(const MachineNeeds& needs, const std::filesystem::path& root = "/");

/// Of the facts those of the place of the record alone.
void look_at_record(MachineFacts& facts, const std::filesystem::path& record);

/// Kernel, scheduler, memory, processor, governor, isolation: what a period of 1 ms needs.
[[nodiscard]] Checks real_time_checks(const MachineFacts& facts, const MachineNeeds& needs);
[[nodiscard]] Check scheduler_check(const MachineFacts& facts, const MachineNeeds& needs);
/// Clock, its resolution, and the place of the record.
[[nodiscard]] Checks clock_checks(const MachineFacts& facts);
[[nodiscard]] Check record_check(const MachineFacts& facts, const MachineNeeds& needs);

}  // namespace antiskid::controller
