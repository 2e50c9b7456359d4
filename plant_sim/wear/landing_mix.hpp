/// Landings of the aircraft of config/ for a forecast: their energies in the brake, and the friction that a heavy rejected take-off requires.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rig_bridge/wear/forecast.hpp"

namespace wear {

/// A mix with its sources, for people and for the hash of results.
struct ConfiguredMix {
    LandingMix mix;
    std::vector<std::filesystem::path> files;
};

/// `text`: NAME=SHARE[,NAME=SHARE...] with the maneuvers of maneuvers.toml. A name such as `medium` stands for medium_a and medium_b in equal parts;
/// shares are normalised. A landing's brake energy is (1 - slip) m v^2 / 2, since at a constant slip the tyre takes the share `slip` of eq. (9),
/// divided by [brake.wear] energy_scale: it is an energy of the brake from which the model was learnt. Throws settings::Error or
/// std::invalid_argument with what would be right.
[[nodiscard]] ConfiguredMix configured_mix(const std::filesystem::path& config, const std::string& text, double slip);

/// Smallest mean mu_b with a torque reserve: below it the brake at full pressure cannot give the torque mu_max F_z r(F_z), with F_z of eq. (2), that
/// the tyre can take from a dry runway at some speed of a heavy stop above drop-out. For the model's brake, by [brake.wear] friction_scale.
struct ReserveLimit {
    double friction = 0.0;
    double torque_Nm = 0.0;  ///< required torque where the reserve is smallest
    double speed_mps = 0.0;  ///< at that point
    std::vector<std::filesystem::path> files;
};
[[nodiscard]] ReserveLimit reserve_limit(const std::filesystem::path& config);

}  // namespace wear
