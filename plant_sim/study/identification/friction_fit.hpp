/// Burckhardt's c1, c2, c3 of eq. (4) from slip and force, by generalised least squares; friction_readings.hpp has the readings and their errors.
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
    double rms = 0.0;           ///< of mu, where slip changes slowly
    double largest_slip = 0.0;  ///< largest measured slip
    double lags_s = 0.0;
    std::vector<double> slip, mu, deviation;  ///< the readings, and the expected standard deviation of each mu

    [[nodiscard]] rig::Surface curve() const { return {.name = surface, .c1 = c1.value, .c2 = c2.value, .c3 = c3.value}; }
};

/// Uses the runs on `surface`. Throws NotIdentifiable if slip does not range from free rolling to beyond the peak.
[[nodiscard]] FrictionFit fit_friction(std::span<const Run> runs, const std::string& surface);

}  // namespace identification
