/// Endurance campaigns by a physical law that is no Gaussian mixture: contact area that runs in, lining that wears as Archard says, a core
/// that loses grip when the lining is nearly gone; and scatter that remembers, from the temperature that the maneuver before left behind
/// and from hysteresis (a play operator) in how friction follows it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "rig_bridge/wear/draw.hpp"
#include "rig_bridge/wear/wear_campaign.hpp"

namespace physical {

struct BrakeLaw {
    double plateau = 0.26;             ///< friction of a run-in brake with all of its lining
    double run_in = 0.06;              ///< above the plateau while the contact is new
    double run_in_J = 12e6;            ///< that the contact takes to run in
    double loss = 0.04;                ///< over the whole lining, linear in what is worn
    double lining_J = 500e6;           ///< that the lining lasts
    double core_loss = 0.05;           ///< lost at the end
    double core_share = 0.06;          ///< of the lining's life in which the core is met
    double per_temperature = -0.0035;  ///< change of friction a standard deviation of temperature
    double memory = 0.6;               ///< of temperature from one maneuver to the next
    double play = 0.8;                 ///< half width of the hysteresis, in deviations of temperature
    double measurement = 0.0012;       ///< standard deviation of what is measured anew each time
    int maneuvers = 500;
};

/// Table III: torque 630.37 +- 4.65 N m over 464.22 +- 5.46 m on a wheel of 0.30 m.
inline double maneuver_energy_J(wear::Generator& generator) {
    const double torque_Nm = 630.37 + 4.65 * wear::normal(generator);
    const double length_m = 464.22 + 5.46 * wear::normal(generator);
    return torque_Nm * length_m / 0.30;
}

/// Friction without scatter when `worn_J` of the lining is used up.
inline double expected_friction(const BrakeLaw& law, double worn_J) {
    const double life = worn_J / law.lining_J;
    const double core = std::max(0.0, (life - 1.0 + law.core_share) / law.core_share);
    return law.plateau + law.run_in / (1.0 + std::pow(worn_J / law.run_in_J, 1.5)) - law.loss * life - law.core_loss * core * core;
}

/// `expected`: takes what each maneuver's friction would have been without scatter.
inline wear::Campaign campaign(const BrakeLaw& law, std::uint64_t seed, std::vector<double>* expected = nullptr) {
    wear::Generator generator = wear::generator_of(seed, 0);
    wear::Campaign out;
    out.source = "physical law";
    out.origin = "made up by the law of tests/wear/physical_campaign.hpp";
    double temperature = wear::normal(generator);
    double following = temperature;  // lags behind temperature within the play
    double worn_J = 0.0;
    double c_e_J = 0.0;
    for (int i = 0; i < law.maneuvers; ++i) {
        temperature = law.memory * temperature + std::sqrt(1.0 - law.memory * law.memory) * wear::normal(generator);
        following = std::clamp(following, temperature - law.play, temperature + law.play);
        const double energy_J = maneuver_energy_J(generator);
        const double friction = expected_friction(law, worn_J) + law.per_temperature * following + law.measurement * wear::normal(generator);
        if (expected != nullptr) expected->push_back(expected_friction(law, worn_J));
        // A hot brake wears faster: the energy axis is not the wear axis.
        worn_J += energy_J * (1.0 + 0.05 * temperature);
        c_e_J += energy_J;
        out.points.push_back({c_e_J, friction});
    }
    return out;
}

/// Brakes that differ: the ordinary one; one that runs in slowly; one that wears fast and is used up before the end; one with much scatter.
inline std::vector<BrakeLaw> laws() {
    BrakeLaw slow_run_in;
    slow_run_in.run_in = 0.08;
    slow_run_in.run_in_J = 40e6;
    BrakeLaw short_lived;
    short_lived.loss = 0.07;
    short_lived.lining_J = 470e6;
    short_lived.core_share = 0.15;
    BrakeLaw scattered;
    scattered.per_temperature = -0.008;
    scattered.measurement = 0.003;
    return {BrakeLaw{}, slow_run_in, short_lived, scattered};
}

/// The brake of config/wear/endurance_campaign.csv: 0.30 new, 0.19 after the 488 MJ of Table III's campaign. Most of its scatter is new in each
/// maneuver: scatter that remembers looks like structure to BIC.
inline BrakeLaw shipped_law() {
    BrakeLaw law;
    law.plateau = 0.25;
    law.run_in = 0.05;
    law.run_in_J = 15e6;
    law.loss = 0.025;
    law.lining_J = 488e6;
    law.core_loss = 0.035;
    law.core_share = 0.12;
    law.per_temperature = -0.002;
    law.measurement = 0.004;
    return law;
}

}  // namespace physical
