#include "rig_bridge/wear/health.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace wear {

const char* name(Condition condition) {
    constexpr std::array kNames{"unknown", "healthy", "suspect", "abnormal"};
    return kNames.at(static_cast<std::size_t>(condition));
}

Verdict HealthMonitor::after(const Point& maneuver) {
    Verdict out;
    const Expectation expected = filter_.expected(maneuver.c_e_J);
    out.expected = expected.mean;
    out.deviation = expected.deviation;
    out.score = filter_.score(maneuver);
    ++maneuvers_;
    if (maneuvers_ <= kUnknownManeuvers) {
        filter_.learn(maneuver);
        return out;
    }
    not_learnt_ = std::abs(out.score) < kNotLearnt ? 0 : not_learnt_ + 1;
    if (not_learnt_ == 0 || not_learnt_ > kMaxNotLearnt) filter_.learn(maneuver);
    const double in_sum = std::clamp(out.score, -kMaxInSum, kMaxInSum);
    low_ = std::max(0.0, low_ - in_sum - kAllowance);
    high_ = std::max(0.0, high_ + in_sum - kAllowance);
    const double two = (out.score + before_) / std::numbers::sqrt2;
    before_ = out.score;
    greatest_.gradual = std::max({greatest_.gradual, low_, high_});
    greatest_.sudden = std::max(greatest_.sudden, std::abs(two));

    struct Test {
        double share;
        const char* says;
    };
    const std::array<Test, 4> tests{{
        {low_ / limits_.gradual, "friction falls away from what this brake's wear explains (glazing?)"},
        {high_ / limits_.gradual,
         "friction rises above what this brake's wear explains (a piston that drags, a pressure that reads "
         "low?)"},
        {-two / limits_.sudden, "friction has dropped"},
        {two / limits_.sudden, "friction has jumped up: torque without pressure (a piston that drags, a pressure that reads low?)"},
    }};
    const auto* const worst = std::max_element(tests.begin(), tests.end(), [](const Test& a, const Test& b) { return a.share < b.share; });
    out.statistic = worst->share;
    if (abnormal_.empty() && worst->share >= 1.0)
        abnormal_ = fmt::format("{}, {:.4f} where {:.4f} +- {:.4f} was expected", worst->says, maneuver.mean_friction, out.expected, out.deviation);
    if (!abnormal_.empty()) {
        out.condition = Condition::abnormal;
        out.reason = abnormal_;
    } else if (worst->share >= kSuspectFrom) {
        out.condition = Condition::suspect;
        out.reason = worst->says;
    } else {
        out.condition = Condition::healthy;
    }
    return out;
}

}  // namespace wear
