/// Time stamps of a record: wall clock when it begins, and from there on as the monotonic clock goes. Somebody who sets the wall clock in the
/// middle of a maneuver changes no figure of it.
#pragma once

#include <algorithm>

#include "firmware/can/frame.hpp"

namespace rig::record {

class StampLabel {
  public:
    /// `wall_minus_monotonic`: now, when the record begins.
    explicit StampLabel(antiskid::can::Time wall_minus_monotonic) : offset_(wall_minus_monotonic) {}

    /// For the kernel's stamp of a frame that came at `monotonic`: the stamp itself to the nanosecond, unless the clock was set;
    /// never before the one before it.
    [[nodiscard]] antiskid::can::Time of(antiskid::can::Time stamp, antiskid::can::Time monotonic) {
        const antiskid::can::Time set = stamp - monotonic - offset_;
        const antiskid::can::Time news = set - set_;
        if (news > kNoise || news < -kNoise) set_ = set;
        return last_ = std::max(last_, stamp - set_);
    }
    [[nodiscard]] antiskid::can::Time of(antiskid::can::Time monotonic) const { return monotonic + offset_; }

  private:
    /// Of two readings of both clocks on a busy machine.
    static constexpr antiskid::can::Time kNoise{500'000};
    antiskid::can::Time offset_;
    antiskid::can::Time set_{};
    antiskid::can::Time last_ = antiskid::can::Time::min();
};

}  // namespace rig::record
