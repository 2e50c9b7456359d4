/// Measures the offset of the wall clock from the monotonic clock. For Linux.
#pragma once

#include <algorithm>
#include <cstdint>
#include <ctime>

#include "firmware/can/wall_clock_offset.hpp"

namespace antiskid::can {

/// Reads the wall clock between two monotonic readings; repeats when they are more than 50 us apart and more than twice as far as the last ones, at
/// most three times in all: where a reading is a slow system call, each of them takes that long.
class WallMinusMonotonic {
  public:
    ClockReading operator()() {
        return measured([](clockid_t clock) {
            timespec now{};
            clock_gettime(clock, &now);
            return Time{std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec};
        });
    }
    /// `read`: Time of a clockid_t.
    template <typename Read>
    ClockReading measured(const Read& read) {
        ClockReading best{};
        Time narrowest = Time::max();
        for (int attempt = 0; attempt < 3 && narrowest > undisturbed_; ++attempt) {
            const Time before = read(CLOCK_MONOTONIC);
            const Time wall = read(CLOCK_REALTIME);
            const Time after = read(CLOCK_MONOTONIC);
            if (after - before >= narrowest) continue;
            narrowest = after - before;
            best = {.wall_minus_monotonic = wall - before - narrowest / 2, .monotonic = after};
        }
        undisturbed_ = std::max(kUndisturbed, 2 * narrowest);
        return best;
    }

  private:
    static constexpr Time kUndisturbed{50'000};
    Time undisturbed_ = kUndisturbed;
};

}  // namespace antiskid::can
