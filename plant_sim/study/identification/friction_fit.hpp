/// Burckhardt's c1, c2, c3 of eq. (4) from slip and force: mu = F_x / F_z by the load cells, slip by the encoders over a window around the
/// instant of each reading. Both have errors; an error of slip counts by the slope of the curve (effective variance: Barker and Diana,
/// American Journal of Physics 42, 1974), slip that moves fast by what the reading's instant may be off.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "plant_sim/model/tyre.hpp"
#include "plant_sim/study/identification/estimate.hpp"
#include "plant_sim/study/identification/motion.hpp"

namespace identification {

struct FrictionFit {
    std::string surface;
    Estimate c1, c2, c3;
    double rms = 0.0;           ///< of mu, where slip moves slowly
    double largest_slip = 0.0;  ///< that was seen
    double lags_s = 0.0;
    std::vector<double> slip, mu, deviation;  ///< the readings, and the expected deviation of each mu

    [[nodiscard]] plant::Surface curve() const {
        return {.name = surface, .c1 = c1.value, .c2 = c2.value, .c3 = c3.value};
    }
};

/// From the runs on `surface`. Throws NotIdentifiable where slip does not reach from free rolling to beyond the peak.
[[nodiscard]] FrictionFit fit_friction(std::span<const Run> runs, const std::string& surface);

}  // namespace identification
