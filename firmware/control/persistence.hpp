/// Conditions that must last before they count, in whole control periods.
#pragma once

#include <cstdint>

#include "firmware/control/types.hpp"

namespace antiskid::control {

/// The nearest whole number of periods of `period_s` in `time_s`, which is not negative.
constexpr std::uint32_t whole_periods(float time_s, float period_s) {
    const float periods = time_s / period_s;
    const auto whole = static_cast<std::uint32_t>(periods);
    return periods - static_cast<float>(whole) < 0.5F ? whole : whole + 1U;
}

/// True once a condition has held for a time without a break.
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

/// One test of a signal. What cannot be runs it up, what can be pays back half: it may come and go.
class Test {
  public:
    Test(float limit_s, float period_s) : limit_(2U * whole_periods(limit_s, period_s)) {}

    /// One reading, counted as a period, or one period: what is wrong with it, or nothing.
    void take(FaultSet wrong) {
        found_ = FaultSet{};
        if (wrong.empty()) {
            if (held_ > 0) --held_;
            return;
        }
        if (held_ < limit_) held_ += 2U;
        if (held_ >= limit_) found_ = wrong;
    }
    /// What the newest is, once wrong ones have added up to the limit.
    [[nodiscard]] FaultSet found() const { return found_; }

  private:
    std::uint32_t limit_;  // half periods
    std::uint32_t held_ = 0;
    FaultSet found_;
};

}  // namespace antiskid::control
