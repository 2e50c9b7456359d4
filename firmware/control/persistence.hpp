/// Conditions that must last before they count, in whole control periods.
#pragma once

#include <cstdint>

#include "firmware/control/types.hpp"

namespace antiskid::control {

/// `time_s` >= 0 in periods of `period_s`, rounded to the nearest whole number.
constexpr std::uint32_t whole_periods(float time_s, float period_s) {
    const float periods = time_s / period_s;
    const auto whole = static_cast<std::uint32_t>(periods);
    return periods - static_cast<float>(whole) < 0.5F ? whole : whole + 1U;
}

/// True once a condition has held for a time without interruption.
class Persistence {
  public:
    Persistence(float limit_s, float period_s) : limit_(whole_periods(limit_s, period_s)) {}

    /// One period; true while `condition` has held for the limit or longer.
    bool holds(bool condition) {
        if (!condition) {
            held_ = 0;
            return false;
        }
        if (held_ < limit_) ++held_;
        return held_ >= limit_;
    }

  private:
    std::uint32_t limit_;
    std::uint32_t held_ = 0;
};

/// Counts bad readings of a signal against good ones; a good one takes back half of a bad one, so that an intermittent fault is found.
class FaultCounter {
  public:
    FaultCounter(float limit_s, float period_s) : limit_(2U * whole_periods(limit_s, period_s)) {}

    /// Takes the faults of one reading (counted as a period) or of one period; empty if it is good.
    void take(FaultSet wrong) {
        found_ = FaultSet{};
        if (wrong.empty()) {
            if (held_ > 0) --held_;
            return;
        }
        if (held_ < limit_) held_ += 2U;
        if (held_ >= limit_) found_ = wrong;
    }
    /// Faults of the newest reading, once bad ones have added up to the limit.
    [[nodiscard]] FaultSet found() const { return found_; }

  private:
    std::uint32_t limit_;  // half periods
    std::uint32_t held_ = 0;
    FaultSet found_;
};

}  // namespace antiskid::control
