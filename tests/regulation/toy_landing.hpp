/// Landings of a brake and a tyre in closed form, for tests of the regulator: the tyre's share is an affine function of the slip reference with
/// noise, the energy of a landing one of four.
#pragma once

#include <array>
#include <cstddef>
#include <random>

#include "rig_bridge/wear/regulator.hpp"

namespace toy {

inline constexpr wear::Range kRange{0.18, 0.38};

struct Plant {
    double offset = 0.02;  ///< tyre share = offset + slope * reference + noise
    double slope = 0.9;
    double noise = 0.02;  ///< half width, uniform
};

class Landings {
  public:
    static constexpr std::array<double, 4> kEnergy_J{3.36e6, 4.26e6, 4.64e6, 8.28e6};
    static constexpr double kMean_J = 5.135e6;
    static constexpr double kDeviation_J = 1.870e6;

    Landings(const Plant& plant, unsigned seed) : plant_(plant), generator_(seed) {}

    wear::Landing next(double reference) {
        const double energy_J = kEnergy_J[static_cast<std::size_t>(generator_() % kEnergy_J.size())];
        const double u = static_cast<double>(generator_() % 2001U) / 1000.0 - 1.0;
        const double share = plant_.offset + plant_.slope * reference + plant_.noise * u;
        return {.reference = reference, .kinetic_J = energy_J, .brake_J = (1.0 - share) * energy_J, .tyre_J = share * energy_J, .j_mu = 0.95};
    }

  private:
    Plant plant_;
    std::mt19937 generator_;
};

/// Both limits at landing `n` where the tyre takes `share` of it all.
inline wear::WearPlan plan(int n, double share, double energy_J = Landings::kMean_J) {
    return {.landings = n,
            .brake_life_J = (1.0 - share) * n * energy_J,
            .tyre_life_J = share * n * energy_J,
            .landing_J = Landings::kMean_J,
            .landing_deviation_J = Landings::kDeviation_J};
}

}  // namespace toy
