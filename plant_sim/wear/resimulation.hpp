/// The paper's Fig. 9: repeats the campaign's maneuvers with the recorded brake energy and friction drawn from the model, and compares the result
/// with the recording.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "rig_bridge/wear/wearing_brake.hpp"

namespace wear {

/// One draw of the campaign. Point i has the recorded c_e, and a friction drawn at the c_e before it. Maneuver 1 begins with recorded c_e minus
/// brake_energy_J(), 0 for a new brake. For the recorded torque the energy of a maneuver does not depend on friction; only the pressure does.
[[nodiscard]] Campaign resimulated(const Campaign& recorded, const Model& model, const ConditionalRule& rule, std::uint64_t seed);

/// One tenth of the campaign's energy.
struct EnergyBand {
    double from_J = 0.0;
    double to_J = 0.0;
    std::size_t maneuvers = 0;  ///< if 0, the following members are 0
    double mean_error = 0.0;    ///< mean simulated minus mean recorded friction
    double deviation_recorded = 0.0;
    double deviation_simulated = 0.0;
    /// Share of recorded points within the central 90 % of the model's conditional distribution.
    double coverage_90 = 0.0;
};

struct Comparison {
    std::vector<EnergyBand> bands;
    double coverage_90 = 0.0;  ///< over all points
    /// Two-sample Kolmogorov-Smirnov distance of recorded and simulated friction, and the probability of a greater one for independent samples of one
    /// distribution (asymptotic). Correlated scatter makes the recorded points less independent than that.
    double ks_distance = 0.0;
    double ks_probability = 0.0;
};

/// `simulated` must be resimulated() of `recorded`.
[[nodiscard]] Comparison compare(const Campaign& recorded, const Campaign& simulated, const Model& model, const ConditionalRule& rule);

/// P(K > distance) for samples of n and m points: Kolmogorov's series with Stephens' correction for finite samples.
[[nodiscard]] double ks_probability(double distance, std::size_t n, std::size_t m);

}  // namespace wear
