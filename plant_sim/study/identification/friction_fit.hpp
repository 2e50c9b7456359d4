/// Burckhardt's c1, c2, c3 of eq. (4) from slip and force, by generalised least squares: see friction_readings.hpp for the readings and their
/// errors.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "plant_sim/study/identification/estimate.hpp"
#include "plant_sim/study/identification/motion.hpp"
#include "rig_bridge/rig/tyre.hpp"

namespace identification {

struct FrictionFit {
    std::string surface;
    Estimate c1, c2, c3;
    double rms = 0.0;           ///< of mu, where slip moves slowly
    double largest_slip = 0.0;  ///< that was seen
    double lags_s = 0.0;
    std::vector<double> slip, mu, deviation;  ///< the readings, and the expected deviation of each mu

    [[nodiscard]] rig::Surface curve() const { return {.name = surface, .c1 = c1.value, .c2 = c2.value, .c3 = c3.value}; }
};

/// From the runs on `surface`. Throws NotIdentifiable where slip does not reach from free rolling to beyond the peak.
[[nodiscard]] FrictionFit fit_friction(std::span<const Run> runs, const std::string& surface);

}  // namespace identification
