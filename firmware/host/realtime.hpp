/// What the operating system must grant for a steady period. Each right that is missing comes back as a
/// sentence that names it and what mends it; the program goes on without.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace antiskid::host {

struct RealtimeRequest {
    int priority = 80;       ///< SCHED_FIFO 1 to 99; 0 leaves ordinary scheduling
    std::optional<int> cpu;  ///< pin the loop to this processor
};

/// For the whole process, before the loop's thread starts: no page of it is ever swapped out or first touched
/// in the loop.
[[nodiscard]] std::optional<std::string> lock_memory();

/// For the calling thread: touches its stack, pins it, raises its priority. Returns one sentence for each
/// thing refused.
[[nodiscard]] std::vector<std::string> enter_realtime(const RealtimeRequest& request);

}  // namespace antiskid::host
