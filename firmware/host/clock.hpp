/// The machine's clock as the loop uses it; injected, so that tests bring their own time.
#pragma once

#include "firmware/control/types.hpp"

namespace antiskid::host {

using control::Time;

class Clock {
  public:
    virtual ~Clock() = default;
    [[nodiscard]] virtual Time now() = 0;
    /// Returns at `deadline` or later, at once if it has passed. Not cut short by signals.
    virtual void sleep_until(Time deadline) = 0;
};

/// CLOCK_MONOTONIC; sleeps to absolute deadlines, so that the time between two calls never adds up to drift.
class MonotonicClock final : public Clock {
  public:
    [[nodiscard]] Time now() override;
    void sleep_until(Time deadline) override;
};

}  // namespace antiskid::host
