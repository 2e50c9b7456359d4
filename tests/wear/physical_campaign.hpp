/// Endurance campaigns by the law of a lining, which is no Gaussian mixture, and a hot brake that wears faster.
#pragma once

#include <cstdint>
#include <vector>

#include "firmware/host/settings/settings.hpp"
#include "rig_bridge/wear/draw.hpp"
#include "rig_bridge/wear/lining_law.hpp"
#include "rig_bridge/wear/load_brake_wear.hpp"
#include "rig_bridge/wear/wear_campaign.hpp"

namespace physical {

using BrakeLaw = wear::LiningLaw;

/// Table III: torque 630.37 +- 4.65 N m over 464.22 +- 5.46 m on a wheel of 0.30 m.
inline double maneuver_energy_J(wear::Generator& generator) {
    const double torque_Nm = 630.37 + 4.65 * wear::normal(generator);
    const double length_m = 464.22 + 5.46 * wear::normal(generator);
    return torque_Nm * length_m / 0.30;
}

/// `expected`: takes what each maneuver's friction would have been without scatter.
inline wear::Campaign campaign(const BrakeLaw& law, std::uint64_t seed, std::vector<double>* expected = nullptr, int maneuvers = 500) {
    wear::Generator generator = wear::generator_of(seed, 0);
    wear::Campaign out;
    out.source = "physical law";
    out.origin = "made up by the law of tests/wear/physical_campaign.hpp";
    wear::LiningTemperature temperature(wear::normal(generator));
    double worn_J = 0.0;
    double c_e_J = 0.0;
    for (int i = 0; i < maneuvers; ++i) {
        temperature.step(law, wear::normal(generator));
        const double energy_J = maneuver_energy_J(generator);
        const double without_scatter = wear::expected_friction(law, worn_J);
        if (expected != nullptr) expected->push_back(without_scatter);
        // A hot brake wears faster: the energy axis is not the wear axis.
        worn_J += energy_J * (1.0 + 0.05 * temperature.temperature());
        c_e_J += energy_J;
        out.points.push_back({c_e_J, without_scatter + law.per_temperature * temperature.following() + law.measurement * wear::normal(generator)});
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

/// The brake of config/wear/endurance_campaign.csv: 0.30 new, 0.19 after the 488 MJ of Table III's campaign.
inline BrakeLaw shipped_law() {
    const auto rig = settings::Document::load("config/flywheel_rig.toml");
    return wear::load_brake_wear(rig.root().table("brake").table("wear"), "config").law.value();
}

}  // namespace physical
