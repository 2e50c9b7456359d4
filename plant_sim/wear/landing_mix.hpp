/// Landings of the aircraft of config/ as a forecast needs them: the energy that each leaves in the brake, and the friction that a heavy
/// rejected take-off asks for.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rig_bridge/wear/forecast.hpp"

namespace wear {

/// What a mix was made of, for people and for the hash of results.
struct ConfiguredMix {
    LandingMix mix;
    std::vector<std::filesystem::path> files;
};

/// `text` is NAME=SHARE[,NAME=SHARE...] with the maneuvers of maneuvers.toml; a name such as `medium` stands for medium_a and medium_b in
/// equal parts; shares are normalised. A landing's brake energy is (1 - slip) m v^2 / 2: at a held slip the tyre takes `slip` of eq. (9).
/// It is divided by [brake.wear] energy_scale: counted on the axis of the brake that the model was learnt on. Throws settings::Error or
/// std::invalid_argument with what would be right.
[[nodiscard]] ConfiguredMix configured_mix(const std::filesystem::path& config, const std::string& text, double slip);

/// The mean mu_b below which a brake at full pressure cannot give the torque that the tyre could take from a dry runway at some speed of a
/// heavy stop (mu_max F_z r(F_z), with F_z of eq. (2)), down to drop-out: its torque reserve is gone. On the model's brake, by [brake.wear]
/// friction_scale.
struct ReserveLimit {
    double friction = 0.0;
    double torque_Nm = 0.0;  ///< asked for where it is scarcest
    double speed_mps = 0.0;  ///< there
    std::vector<std::filesystem::path> files;
};
[[nodiscard]] ReserveLimit reserve_limit(const std::filesystem::path& config);

}  // namespace wear
