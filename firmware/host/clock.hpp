/// The clock of the control loop; injected, so that tests can control time.
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

/// CLOCK_MONOTONIC; sleeps until absolute deadlines, so that delays do not accumulate.
class MonotonicClock final : public Clock {
  public:
    [[nodiscard]] Time now() override;
    void sleep_until(Time deadline) override;
};

}  // namespace antiskid::host
