/// How long to wait before a lost link is tried again.
#pragma once

#include <algorithm>
#include <chrono>

namespace rig::modbus {

class Backoff {
  public:
    using Time = std::chrono::milliseconds;

    /// `least` > 0, `most` >= `least`.
    Backoff(Time min, Time max) : min_(min), max_(max), next_(min) {}

    /// least, twice that, four times, ... up to most.
    [[nodiscard]] Time next() {
        const Time now = next_;
        next_ = std::min(2 * next_, max_);
        return now;
    }
    void reset() { next_ = min_; }

  private:
    Time min_;
    Time max_;
    Time next_;
};

}  // namespace rig::modbus
