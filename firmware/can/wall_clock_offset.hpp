/// Takes kernel time stamps, which are wall clock, to the monotonic clock.
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

/// Reads both clocks rarely: each reading costs a system call where the kernel has no vDSO.
class WallClockOffset {
  public:
    using Clock = std::function<ClockReading()>;
    static constexpr std::uint32_t kBatches = 1024;
    static constexpr Time kLeap{2'000'000};

    explicit WallClockOffset(Clock clock) : clock_(std::move(clock)), offset_(clock_().wall_minus_monotonic) {}

    /// Once per batch of frames, before its stamps.
    void next_batch() {
        if (++batches_ < kBatches) return;
        const Time before = offset_;
        static_cast<void>(measure());
        // The clock was set while frames may be waiting that have its old stamps: the first with a new one leaps, and tells; or else
        // the next reading does.
        was_set_ = !was_set_ && differs(offset_, before);
        if (was_set_) offset_ = before;
    }
    /// Never still to come.
    [[nodiscard]] Time monotonic(Time wall) {
        const Time mapped = wall - offset_;
        if (mapped >= last_ && mapped - last_ <= kLeap) return last_ = mapped;
        const Time before = offset_;
        const Time now = measure();
        const Time fresh = wall - offset_;
        // Stamped before the clock was set and read after: of both times the later one that is not still to come.
        if (differs(offset_, before) && mapped <= now && (fresh > now + kLeap || fresh < mapped)) {
            offset_ = before;
            return last_ = mapped;
        }
        // A clock that was set and set back before anybody looked leaves stamps of an offset that nobody saw.
        return last_ = std::min(fresh, now);
    }

  private:
    [[nodiscard]] static bool differs(Time a, Time b) noexcept { return a - b > kLeap || b - a > kLeap; }
    /// The monotonic clock then.
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
