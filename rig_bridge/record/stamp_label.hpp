/// Time stamps of a record: wall clock at its beginning, continued by the monotonic clock, so that setting the wall clock during a maneuver changes
/// none of its figures.
#pragma once

#include <algorithm>

#include "firmware/can/frame.hpp"

namespace rig::record {

class StampLabel {
  public:
    /// `wall_minus_monotonic`: clock offset at the beginning of the record.
    explicit StampLabel(antiskid::can::Time wall_minus_monotonic) : offset_(wall_minus_monotonic) {}

    /// For the kernel's stamp of a frame that came at `monotonic`: the kernel's stamp itself, unless the clock was set; never decreases.
    [[nodiscard]] antiskid::can::Time of(antiskid::can::Time stamp, antiskid::can::Time monotonic) {
        const antiskid::can::Time set = stamp - monotonic - offset_;
        const antiskid::can::Time change = set - set_;
        if (change > kNoise || change < -kNoise) set_ = set;
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
