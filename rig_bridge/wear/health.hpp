/// Health of one brake, maneuver by maneuver: are its newest maneuvers those of a brake like the ones that the population knows?
///
/// Each maneuver's friction is scored against what the maneuvers before it predict for it (BrakeFilter::score): a standard normal deviate z,
/// independent of the ones before, while the brake is healthy, whatever its own level and however its scatter remembers. Three tests, all
/// two-sided:
///
///   gradual   Page's cumulative sums with allowance 1/2: S = max(0, S + |shift of z| - 1/2). A drift: glazing, a lining that is lost.
///   sudden    |z_i + z_(i-1)| / sqrt 2. A step.
///   trend     The newest ten against what was expected of them 20 maneuvers before, over the scatter (the root of the brake's own times
///             the population's). A drift that the filter would follow. In the steady stage alone.
///
/// Run-in and wear-out are stages of their own (Population::steady), with limits of their own, and sums begin anew there.
///
/// Down: friction is lost. Up: there is more torque than the pressure accounts for. A piston that sticks drags with a torque that no pressure
/// asks for; the figures of a maneuver (eq. 7) have no other place for it than friction, drag / torque of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

#include "rig_bridge/wear/brake_filter.hpp"

namespace wear {

enum class Condition : std::uint8_t { unknown, healthy, suspect, abnormal };

struct Verdict {
    Condition condition = Condition::unknown;
    double statistic = 0.0;  ///< the greatest of the tests, as share of its limit: 1 is abnormal
    double score = 0.0;      ///< z of this maneuver
    double expected = 0.0;   ///< friction that was expected of it
    double deviation = 0.0;  ///< standard deviation of that
    std::string reason;      ///< for people; empty unless suspect or abnormal
};

class HealthMonitor {
  public:
    static constexpr int kUnknownManeuvers = 5;  ///< until the brake's own level is known a little
    static constexpr double kSuspectFrom = 0.7;  ///< statistic
    static constexpr double kAllowance = 0.5;    ///< of the cumulative sums: they answer fastest to shifts of 1
    static constexpr double kMaxInSum = 4.0;     ///< one outlier is no trend
    /// A maneuver that far off says nothing about what is ordinary for this brake and is not learnt from, unless as many in a row are like that.
    static constexpr double kNotLearnt = 4.0;
    static constexpr int kMaxNotLearnt = 3;
    static constexpr std::size_t kAhead = 20;  ///< maneuvers that the trend test looks ahead
    static constexpr std::size_t kTrend = 10;  ///< maneuvers that it takes together
    /// Of the steady stage's end: brakes that are not members wear out earlier than the first of those, and their trend is steep.
    static constexpr double kTrendUntil = 0.85;

    /// `population` must outlive this.
    explicit HealthMonitor(const Population& population);
    explicit HealthMonitor(Population&&) = delete;

    /// After a finished maneuver, in their order. Abnormal once is abnormal for good: brakes do not heal.
    [[nodiscard]] Verdict after(const Point& maneuver);

    /// The greatest of the statistics so far, in deviates: what limits are learnt from.
    [[nodiscard]] const HealthLimits& greatest() const { return greatest_; }
    [[nodiscard]] const BrakeFilter& filter() const { return filter_; }

  private:
    struct Expected {
        double at_J, friction;
    };
    void look_ahead(double c_e_J);
    /// Of the newest maneuvers, signed; 0 while there are too few.
    [[nodiscard]] double trend(const Point& maneuver);

    HealthLimits limits_;
    BrakeFilter filter_;
    HealthLimits greatest_;
    int maneuvers_ = 0;
    int not_learnt_ = 0;  // in a row
    double low_ = 0.0;    // cumulative sums
    double high_ = 0.0;
    double before_ = 0.0;  // z of the maneuver before
    bool steady_ = false;
    double own_variance_;    // of what is new in each maneuver, from differences of neighbours
    double friction_ = 0.0;  // of the maneuver before
    double first_J_ = 0.0;
    std::deque<Expected> ahead_;
    std::deque<double> off_;  // from what was expected kAhead before, newest last
    std::string abnormal_;
};

[[nodiscard]] const char* name(Condition condition);

}  // namespace wear
