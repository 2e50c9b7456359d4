/// A surface's friction over slip from slip and force, by generalised least squares: eq. (4), or a magic formula where that fits clearly better.
/// friction_readings.hpp has the readings and their errors.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plant_sim/study/identification/estimate.hpp"
#include "plant_sim/study/identification/motion.hpp"
#include "rig_bridge/rig/tyre.hpp"

namespace identification {

struct Coefficient {
    std::string name;
    Estimate estimate;
};

struct FrictionFit {
    std::string surface;
    std::vector<Coefficient> coefficients;  ///< c1, c2, c3 of eq. (4); or B, C, D, E of the magic formula
    rig::Surface curve;                     ///< with these coefficients
    double misfit = 0.0;        ///< of the readings from the curve, over what their errors explain, RMS: about 1 for a curve of the road's shape
    double rms = 0.0;           ///< of mu, where slip changes slowly
    double largest_slip = 0.0;  ///< largest measured slip
    double lags_s = 0.0;
    std::vector<double> slip, mu, deviation;  ///< the readings, and the expected standard deviation of each mu

    /// The coefficient with this name; throws std::out_of_range.
    [[nodiscard]] const Estimate& of(std::string_view name) const;
};

/// A misfit beyond which neither curve has the shape of the readings.
inline constexpr double kMaxMisfit = 3.0;

/// Uses the runs on `surface`. Throws NotIdentifiable if slip does not range from free rolling to beyond the peak.
[[nodiscard]] FrictionFit fit_friction(std::span<const Run> runs, const std::string& surface);

}  // namespace identification
