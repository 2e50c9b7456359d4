/// The paper's Fig. 9: the campaign's maneuvers again, each taking the brake energy that was recorded, its friction drawn by the model; and
/// how near that comes to what was recorded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "rig_bridge/wear/wearing_brake.hpp"

namespace wear {

/// One draw of the campaign. Point i has the recorded c_e and a friction drawn at the c_e before it; maneuver 1 begins with what
/// brake_energy_J() leaves before it (0 for a new brake). With the recorded torque the energy of a maneuver is the recorded one, whatever the
/// friction; what changes is the pressure.
[[nodiscard]] Campaign resimulated(const Campaign& recorded, const Model& model, const ConditionalRule& rule, std::uint64_t seed);

/// One tenth of the campaign's energy.
struct EnergyBand {
    double from_J = 0.0;
    double to_J = 0.0;
    std::size_t maneuvers = 0;  ///< the rest is 0 when there is none
    double mean_error = 0.0;    ///< mean of simulated less mean of recorded friction
    double deviation_recorded = 0.0;
    double deviation_simulated = 0.0;
    /// Share of recorded points within the central 90 % of the model's conditional distribution.
    double coverage_90 = 0.0;
};

struct Comparison {
    std::vector<EnergyBand> bands;
    double coverage_90 = 0.0;  ///< over all points
    /// Two-sample Kolmogorov-Smirnov distance of recorded and simulated friction, and the probability of a greater one between independent
    /// samples of one distribution (asymptotic). Scatter that remembers makes recorded points less independent than that.
    double ks_distance = 0.0;
    double ks_probability = 0.0;
};

/// `simulated` as resimulated() gives it for `recorded`.
[[nodiscard]] Comparison compare(const Campaign& recorded, const Campaign& simulated, const Model& model, const ConditionalRule& rule);

/// P(K > distance) for samples of n and m points: Kolmogorov's series with Stephens' correction for finite samples.
[[nodiscard]] double ks_probability(double distance, std::size_t n, std::size_t m);

}  // namespace wear
