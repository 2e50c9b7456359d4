/// Waiting times before reconnecting a lost link.
#pragma once

#include <algorithm>
#include <chrono>

namespace rig::modbus {

class Backoff {
  public:
    using Time = std::chrono::milliseconds;

    /// `min` > 0, `max` >= `min`.
    Backoff(Time min, Time max) : min_(min), max_(max), next_(min) {}

    /// `min`, twice that, four times that, ... up to `max`.
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
