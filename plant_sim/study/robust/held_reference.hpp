/// Friction of a slip reference that is held exactly on one surface.
#pragma once

#include "firmware/control/config.hpp"
#include "plant_sim/model/rig.hpp"

namespace robust {

/// Friction times distance: numerator and denominator of eq. (16).
struct FrictionDistance {
    double had_m = 0.0;
    double max_m = 0.0;  ///< with the peak friction all the way
};
/// From one speed down to another on `rig.surface`, with the slip `slip_reference` at every instant, at low speed reduced as `config` has it: without
/// pressure build-up and control error.
[[nodiscard]] FrictionDistance held_distance(const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double slip_reference,
                                             double from_mps, double to_mps);

/// J_mu, eq. (16), of such a stop from `rig.brake_on_mps` to drop-out, 0 to 1.
[[nodiscard]] double held_j_mu(const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double slip_reference,
                               double drop_out_mps);

}  // namespace robust
