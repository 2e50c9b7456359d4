/// Takes kernel time stamps, which are wall clock, to the monotonic clock.
#pragma once

#include <cstdint>

#include "firmware/can/frame.hpp"

namespace antiskid::can {

/// Reads both clocks rarely: each reading costs a system call where the kernel has no vDSO. Clock is a
/// function object without arguments that returns wall clock minus monotonic clock now.
template <typename Clock>
class WallClockOffset {
  public:
    static constexpr std::uint32_t kBatches = 1024;
    static constexpr Time kLeap{2'000'000};

    explicit WallClockOffset(Clock clock) : clock_(clock), offset_(clock_()) {}

    /// Once per batch of frames, before its stamps.
    void next_batch() {
        if (++batches_ >= kBatches) measure();
    }
    [[nodiscard]] Time monotonic(Time wall) {
        const Time mapped = wall - offset_;
        if (mapped >= last_ && mapped - last_ <= kLeap) return last_ = mapped;
        measure();
        return last_ = wall - offset_;
    }

  private:
    void measure() {
        offset_ = clock_();
        batches_ = 0;
    }

    Clock clock_;
    Time offset_;
    Time last_{};
    std::uint32_t batches_ = 0;
};

}  // namespace antiskid::can
