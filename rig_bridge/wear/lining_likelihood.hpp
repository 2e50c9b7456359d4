/// What readings of the lining say of a brake's life, whatever its friction: worn = slope c_e / L + error, where the slope is normal.
///
///     LiningLikelihood lining(curves, 0.2);
///     lining.read({2.0e9, 0.52});
///     lining.given(lives_J, 200);  // the same lives, weighed by the readings
///
/// The slope is how far the lining is worn when friction ends the life. Pure.
#pragma once

#include <cstddef>
#include <vector>

#include "rig_bridge/wear/life_curves.hpp"

namespace wear {

class LiningLikelihood {
  public:
    /// The slope is that of `curves`, with `more` of it as further standard deviation. Without learnt readings nothing must be read.
    explicit LiningLikelihood(const LifeCurves& curves, double more = 0.0);

    void read(const LiningReading& reading);
    [[nodiscard]] bool any() const { return squares_J2_ > 0.0; }
    /// Of all readings together, up to a constant.
    [[nodiscard]] double log_likelihood(double life_J) const;
    /// `count` equally probable lives, rising, given the readings. `lives_J`: rising, equally probable without them; not empty.
    [[nodiscard]] std::vector<double> given(const std::vector<double>& lives_J, std::size_t count) const;

  private:
    double log_life_, log_life_deviation_;
    double slope_, slope_by_life_, slope_variance_, variance_;
    double squares_J2_ = 0.0, products_J_ = 0.0;  // sums of c_e^2 and c_e worn
};

}  // namespace wear
