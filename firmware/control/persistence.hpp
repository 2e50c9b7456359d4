/// Conditions that must last before they count, in whole control periods.
#pragma once

#include <cstdint>

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

/// The same for a condition that may come and go: good periods pay back half of what bad ones have run up.
class Suspicion {
  public:
    Suspicion(float limit_s, float period_s) : limit_(2U * whole_periods(limit_s, period_s)) {}

    bool holds(bool condition) {
        if (!condition) {
            if (held_ > 0) --held_;
            return false;
        }
        if (held_ < limit_) held_ += 2U;
        return held_ >= limit_;
    }

  private:
    std::uint32_t limit_;  // half periods
    std::uint32_t held_ = 0;
};

}  // namespace antiskid::control
