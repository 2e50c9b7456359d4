/// Converts between SI units and the standardised coordinates used by EM.
#pragma once

#include <vector>

#include "rig_bridge/wear/em.hpp"
#include "rig_bridge/wear/mixture.hpp"

namespace wear {

/// Mean and standard deviation (of the population, not the sample) of each coordinate.
struct StandardScale {
    double c_mean_J = 0.0;
    double c_deviation_J = 1.0;
    double mu_mean = 0.0;
    double mu_deviation = 1.0;
};
[[nodiscard]] StandardScale scale_of(const std::vector<Point>& points);

[[nodiscard]] StandardPoints standardised(const std::vector<Point>& points, const StandardScale& scale);
[[nodiscard]] StandardMixture standardised(const Mixture& mixture, const StandardScale& scale);
/// Components by energy, ascending.
[[nodiscard]] Mixture in_units(const StandardMixture& mixture, const StandardScale& scale);

}  // namespace wear
