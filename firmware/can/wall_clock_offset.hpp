/// Converts the kernel's wall-clock time stamps to the monotonic clock.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <utility>

#include "firmware/can/frame.hpp"

namespace antiskid::can {

struct ClockReading {
    Time wall_minus_monotonic{};
    Time monotonic{};  ///< now
};

/// Reads the clocks only every kBatches batches or after a jump: a reading costs a system call where there is no vDSO.
class WallClockOffset {
  public:
    using Clock = std::function<ClockReading()>;
    static constexpr std::uint32_t kBatches = 1024;
    static constexpr Time kLeap{2'000'000};

    explicit WallClockOffset(Clock clock) : clock_(std::move(clock)), offset_(clock_().wall_minus_monotonic) {}

    /// Call once per batch of frames, before monotonic().
    void next_batch() {
        if (++batches_ < kBatches) return;
        const Time before = offset_;
        static_cast<void>(measure());
        // The wall clock was set, but queued frames may still have old stamps: keep the old offset until a stamp jumps or the next reading confirms
        // the change.
        was_set_ = !was_set_ && differs(offset_, before);
        if (was_set_) offset_ = before;
    }
    /// The stamp on the monotonic clock; never in the future.
    [[nodiscard]] Time monotonic(Time wall) {
        const Time mapped = wall - offset_;
        if (mapped >= last_ && mapped - last_ <= kLeap) return last_ = mapped;
        const Time before = offset_;
        const Time now = measure();
        const Time fresh = wall - offset_;
        // The frame was stamped before the clock was set and is read after it: use the later of both times that is not in the future.
        if (differs(offset_, before) && mapped <= now && (fresh > now + kLeap || fresh < mapped)) {
            offset_ = before;
            return last_ = mapped;
        }
        // If the clock was set and set back between two readings, the stamps have an offset that was never measured.
        return last_ = std::min(fresh, now);
    }

  private:
    [[nodiscard]] static bool differs(Time a, Time b) noexcept { return a - b > kLeap || b - a > kLeap; }
    /// Measures the offset; returns the monotonic time of the measurement.
    Time measure() noexcept {
        const ClockReading reading = clock_();
        offset_ = reading.wall_minus_monotonic;
        batches_ = 0;
        return reading.monotonic;
    }

    Clock clock_;
    Time offset_;
    Time last_{};
    std::uint32_t batches_ = 0;
    bool was_set_ = false;
};

}  // namespace antiskid::can
