/// How long to wait before a lost link is tried again.
#pragma once

#include <algorithm>
#include <chrono>

namespace rig {

class Backoff {
  public:
    using Time = std::chrono::milliseconds;

    /// `least` > 0, `most` >= `least`.
    Backoff(Time least, Time most) : least_(least), most_(most), next_(least) {}

    /// least, twice that, four times, ... up to most.
    [[nodiscard]] Time next() {
        const Time now = next_;
        next_ = std::min(2 * next_, most_);
        return now;
    }
    void reset() { next_ = least_; }

  private:
    Time least_;
    Time most_;
    Time next_;
};

}  // namespace rig
