/// Wait until the next period: absolute deadlines on a fixed grid, missed ones counted and left out.
#pragma once

#include <cstdint>

#include "firmware/host/clock.hpp"

namespace antiskid::host {

class PeriodicTimer {
  public:
    struct Tick {
        Time deadline{};            ///< newest grid point that has passed
        Time woke{};                ///< clock when the wait ended
        Time latency{};             ///< of `woke` behind the grid point that was waited for, the first one if points were skipped
        std::uint64_t skipped = 0;  ///< grid points before `deadline` that got no tick of their own: missed periods
    };

    /// The first deadline is one `period` from now. `clock` must outlive the timer.
    PeriodicTimer(Clock& clock, Time period) : clock_(clock), period_(period), next_(clock.now() + period) {}

    /// Returns at the next grid point, or at once if that has passed. A caller who is late by whole periods,
    /// or a clock that jumps ahead, gets one tick that says how many it skipped, never a burst to catch up.
    [[nodiscard]] Tick wait();

  private:
    Clock& clock_;
    Time period_;
    Time next_;
};

}  // namespace antiskid::host
