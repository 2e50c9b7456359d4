/// Requests from the operating system what a steady period needs. Each refusal is returned as a sentence that names the missing right and its remedy;
/// the program continues without it.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace antiskid::host {

struct RealtimeRequest {
    int priority = 80;       ///< SCHED_FIFO 1 to 99; 0 leaves ordinary scheduling
    std::optional<int> cpu;  ///< pin the loop to this processor
};

/// For the whole process, before the loop's thread starts: locks all pages, so that the loop has no page faults.
[[nodiscard]] std::optional<std::string> lock_memory();

/// For the calling thread: touches its stack, pins it, raises its priority. Returns one sentence per refusal.
[[nodiscard]] std::vector<std::string> enter_realtime(const RealtimeRequest& request);

}  // namespace antiskid::host
