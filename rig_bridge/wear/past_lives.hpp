/// How much energy the brakes of a population took until their mean friction was below a limit: what is known about the life of a brake
/// before its own friction says anything, or when it wears like none of them.
#pragma once

#include <cstddef>

#include "rig_bridge/wear/population.hpp"

namespace wear {

/// The logarithm of the life of one more brake is distributed as Student's t about the mean of the others.
class PastLives {
  public:
    PastLives(const Population& population, double limit);

    /// Whether half of the members, and two at least, came below the limit.
    [[nodiscard]] bool known() const { return known_; }
    /// The energy that a share in (0, 1) of the brakes do not reach, of those that are not worn out at `c_e_J`. Only when known.
    [[nodiscard]] double life_J(double c_e_J, double share) const;

  private:
    bool known_ = false;
    double freedom_ = 1.0;
    double log_mean_ = 0.0;
    double log_deviation_ = 0.0;  // of one more brake
};

/// The energy from which on the curve is below the limit, and no more than `end_J`: friction is below it in run-in, too, where contact is not
/// there yet.
[[nodiscard]] double crossing_J(const MeanCurve& curve, double limit, double step_J, double end_J);

}  // namespace wear
