#include "rig_bridge/wear/health.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

namespace wear {

const char* name(Condition condition) {
    constexpr std::array kNames{"unknown", "healthy", "suspect", "abnormal"};
    return kNames.at(static_cast<std::size_t>(condition));
}

HealthMonitor::HealthMonitor(const Population& population)
    : limits_(population.limits),
      filter_(population),
      own_variance_(population.scatter.remembered * population.scatter.remembered + population.scatter.fresh * population.scatter.fresh) {
    if (population.curves.lives > 0) glazing_.emplace(population.curves);
}

void HealthMonitor::look_ahead(double c_e_J) {
    constexpr double kNegligible = 1e-6;
    const double step_J = (c_e_J - first_J_) / std::max(1, maneuvers_ - 1);
    const double at_J = c_e_J + static_cast<double>(kAhead) * step_J;
    double friction = 0.0;
    for (const BrakeFilter::Hypothesis& h : filter_.hypotheses())
        if (h.weight > kNegligible) friction += h.weight * filter_.mean_friction(h, at_J);
    ahead_.push_back({at_J, friction});
}

double HealthMonitor::trend(const Point& maneuver) {
    constexpr double kKept = 0.97;
    const double step = maneuver.mean_friction - friction_;
    own_variance_ = kKept * own_variance_ + (1.0 - kKept) * 0.5 * step * step;
    std::optional<double> expected;
    for (; !ahead_.empty() && ahead_.front().at_J <= maneuver.c_e_J; ahead_.pop_front()) expected = ahead_.front().friction;
    if (expected) off_.push_back(maneuver.mean_friction - *expected);
    if (off_.size() > kTrend) off_.pop_front();
    if (off_.size() < kTrend) return 0.0;
    const Scatter& s = filter_.population().scatter;
    const double scatter = std::sqrt(std::sqrt(own_variance_) * std::hypot(s.remembered, s.fresh));
    return std::accumulate(off_.begin(), off_.end(), 0.0) / static_cast<double>(kTrend) / scatter;
}

Verdict HealthMonitor::after(const Point& maneuver) {
    Verdict out;
    const Expectation expected = filter_.expected(maneuver.c_e_J);
    out.expected = expected.mean;
    out.deviation = expected.deviation;
    out.score = filter_.score(maneuver);
    ++maneuvers_;
    if (maneuvers_ == 1) first_J_ = maneuver.c_e_J;
    const double drift = maneuvers_ == 1 || glazing_ ? 0.0 : trend(maneuver);
    const double glazed = glazing_ ? glazing_->after(maneuver) : 0.0;
    friction_ = maneuver.mean_friction;
    not_learnt_ = maneuvers_ <= kUnknownManeuvers || std::abs(out.score) < kNotLearnt ? 0 : not_learnt_ + 1;
    if (not_learnt_ == 0 || not_learnt_ > kMaxNotLearnt) filter_.learn(maneuver);
    if (!glazing_) look_ahead(maneuver.c_e_J);
    if (maneuvers_ <= kUnknownManeuvers) return out;
    if (const bool steady = filter_.population().steady.holds(maneuver.c_e_J); steady != steady_) {
        steady_ = steady;
        low_ = high_ = 0.0;
        off_.clear();
    }
    const double in_sum = std::clamp(out.score, -kMaxInSum, kMaxInSum);
    low_ = std::max(0.0, low_ - in_sum - kAllowance);
    high_ = std::max(0.0, high_ + in_sum - kAllowance);
    const double two = (out.score + before_) / std::numbers::sqrt2;
    before_ = out.score;
    const HealthTest gradual = steady_ ? &HealthLimits::gradual : &HealthLimits::unsteady_gradual;
    const HealthTest sudden = steady_ ? &HealthLimits::sudden : &HealthLimits::unsteady_sudden;
    const double tended = steady_ && maneuver.c_e_J <= kTrendUntil * filter_.population().steady.to_J ? drift : 0.0;
    greatest_.*gradual = std::max({greatest_.*gradual, low_, high_});
    greatest_.*sudden = std::max(greatest_.*sudden, std::abs(two));
    greatest_.trend = std::max(greatest_.trend, std::abs(tended));
    greatest_.glazing = std::max(greatest_.glazing, glazed);

    struct Test {
        double share;
        const char* says;
    };
    const std::array<Test, 4> tests{{
        {std::max({low_ / (limits_.*gradual), -tended / limits_.trend, glazed / limits_.glazing}),
         "friction falls away from what this brake's wear explains (glazing?)"},
        {std::max(high_ / (limits_.*gradual), tended / limits_.trend),
         "friction rises above what this brake's wear explains (a piston that drags, a pressure that reads low?)"},
        {-two / (limits_.*sudden), "friction has dropped"},
        {two / (limits_.*sudden), "friction has jumped up: torque without pressure (a piston that drags, a pressure that reads low?)"},
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
