/// Monitors the health of one brake: tests whether its newest maneuvers are consistent with the brakes of the population.
///
/// Each maneuver's friction is scored against its prediction from the earlier ones (BrakeFilter::score): for a healthy brake a standard normal
/// deviate z, independent of the earlier ones, whatever the brake's level and the correlation of its scatter. Tests, all but the last two-sided:
///
///   gradual   Page's cumulative sums with allowance 1/2: S = max(0, S + |shift of z| - 1/2). A drift: glazing, a lining that is lost.
///   sudden    |z_i + z_(i-1)| / sqrt 2. A step.
///   trend     The newest ten against what was expected of them 20 maneuvers before, over the scatter (the root of the brake's own times
///             the population's). A drift that the filter would follow. In the steady stage alone, and only by a population without life curves.
///   glazing   Where it has them: the likelihood of a glaze that has begun (glazing_watch.hpp), in all of life.
///
/// Run-in and wear-out (Population::steady) have separate limits, and the sums are reset there.
///
/// A fall means lost friction, a rise more torque than the pressure explains. A sticking piston causes drag torque without pressure, which eq. (7)
/// counts as friction, increased by the ratio drag / torque.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "rig_bridge/wear/brake_filter.hpp"
#include "rig_bridge/wear/glazing_watch.hpp"

namespace wear {

enum class Condition : std::uint8_t { unknown, healthy, suspect, abnormal };

struct Verdict {
    Condition condition = Condition::unknown;
    double statistic = 0.0;  ///< largest test statistic, as share of its limit: 1 is abnormal
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
    /// A maneuver with a score beyond this is not learnt from, unless as many in a row are beyond it.
    static constexpr double kNotLearnt = 4.0;
    static constexpr int kMaxNotLearnt = 3;
    static constexpr std::size_t kAhead = 20;  ///< maneuvers that the trend test looks ahead
    static constexpr std::size_t kTrend = 10;  ///< maneuvers that it takes together
    /// The trend test ends at this share of the steady stage's end: other brakes may wear out before the first member, with a steep trend.
    static constexpr double kTrendUntil = 0.85;

    /// `population` must outlive this.
    explicit HealthMonitor(const Population& population);
    explicit HealthMonitor(Population&&) = delete;

    /// Call after each finished maneuver, in order. `abnormal` is permanent.
    [[nodiscard]] Verdict after(const Point& maneuver);

    /// Largest statistics so far, in standard deviations; limits are learnt from these.
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
    std::optional<GlazingWatch> glazing_;
    std::deque<Expected> ahead_;
    std::deque<double> off_;  // from what was expected kAhead before, newest last
    std::string abnormal_;
};

[[nodiscard]] const char* name(Condition condition);

}  // namespace wear
