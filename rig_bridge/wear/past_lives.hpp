/// Distribution of the energy that the brakes of a population took until their mean friction was below a limit: the estimate of a brake's life before
/// its own friction shows anything, or if it wears unlike the population.
#pragma once

#include "rig_bridge/wear/population.hpp"

namespace wear {

/// The logarithm of the life of one more brake is distributed as Student's t about the mean of the others.
class PastLives {
  public:
    PastLives(const Population& population, double limit);

    /// Whether at least half of the members, and at least two, fell below the limit.
    [[nodiscard]] bool known() const { return known_; }
    /// Quantile `share`, in (0, 1), of the life energy of brakes that are not worn out at `c_e_J`. Requires known().
    [[nodiscard]] double life_J(double c_e_J, double share) const;

  private:
    bool known_ = false;
    double freedom_ = 1.0;
    double log_mean_ = 0.0;
    double log_deviation_ = 0.0;  // of one more brake
};

/// The energy from which on the curve stays below the limit, at most `end_J`; friction may also be below it during run-in.
[[nodiscard]] double crossing_J(const MeanCurve& curve, double limit, double step_J, double end_J);

}  // namespace wear
