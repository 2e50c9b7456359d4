/// Waits for the next period: absolute deadlines on a fixed grid; missed deadlines are counted and skipped.
#pragma once

#include <cstdint>

#include "firmware/host/clock.hpp"

namespace antiskid::host {

class PeriodicTimer {
  public:
    struct Tick {
        Time deadline{};            ///< newest grid point that has passed
        Time woke{};                ///< clock when the wait ended
        Time latency{};             ///< from the grid point that was waited for (the first one, if points were skipped) to `woke`
        std::uint64_t skipped = 0;  ///< grid points before `deadline` without a tick of their own: missed periods
    };

    /// The first deadline is one `period` from now. `clock` must outlive the timer.
    PeriodicTimer(Clock& clock, Time period) : clock_(clock), period_(period), next_(clock.now() + period) {}

    /// Returns at the next grid point, or at once if that has passed. After a delay of several periods, or a jump of the clock, there is one tick
    /// with the number of skipped points, never a burst of ticks.
    [[nodiscard]] Tick wait();

  private:
    Clock& clock_;
    Time period_;
    Time next_;
};

}  // namespace antiskid::host
