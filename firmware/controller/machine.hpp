/// Checks whether the computer can keep a steady period and store a whole record. machine_facts() reads the facts from this machine; tests fill them
/// in themselves.
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
    std::optional<int> cpu;              ///< processor to pin the loop to
    std::filesystem::path record = ".";  ///< where record, report or ledger are written; need not exist yet
    double record_bytes = 1e9;           ///< free space needed
};

struct MachineFacts {
    std::string kernel;            ///< uname -v: "#1 SMP PREEMPT_RT Debian ..."
    bool realtime_kernel = false;  ///< /sys/kernel/realtime
    bool fifo_granted = false;     ///< SCHED_FIFO at the wanted priority
    std::uint64_t rtprio_limit = 0;
    bool memory_locked = false;
    bool pinned = false;  ///< the requested processor exists and is allowed
    struct Governor {
        int cpu = 0;
        std::string name;
    };
    std::vector<Governor> governors;  ///< of the loop's processor, or of all; empty: no frequency scaling
    std::string isolated;             ///< isolated processors, in the form of isolcpus=: "2-3,5"
    std::string clock_source;         ///< "tsc", "hpet", ...
    double clock_resolution_s = 0.0;  ///< CLOCK_MONOTONIC
    bool clock_synchronised = false;  ///< the wall clock, by adjtimex(2)
    double record_free_bytes = 0.0;
    std::string record_rejection;  ///< why the record cannot be written; empty: it can
};

/// `root`: directory of proc and sys. Locks the memory of this process, as the loop will.
[[nodiscard]] MachineFacts machine_facts(const MachineNeeds& needs, const std::filesystem::path& root = "/");

/// Updates only the facts about the directory of the record.
void look_at_record(MachineFacts& facts, const std::filesystem::path& record);

/// Kernel, scheduler, memory, processor, governor, isolation: what a period of 1 ms needs.
[[nodiscard]] Checks real_time_checks(const MachineFacts& facts, const MachineNeeds& needs);
[[nodiscard]] Check scheduler_check(const MachineFacts& facts, const MachineNeeds& needs);
/// Monotonic clock and its resolution, and whether the wall clock is synchronised.
[[nodiscard]] Checks clock_checks(const MachineFacts& facts);
[[nodiscard]] Check record_check(const MachineFacts& facts, const MachineNeeds& needs);

}  // namespace antiskid::controller
