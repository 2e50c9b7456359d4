/// What a slip reference offers on one surface, held exactly.
#pragma once

#include "firmware/control/config.hpp"
#include "plant_sim/model/rig.hpp"

namespace robust {

/// Friction times distance, the two terms of eq. (16).
struct FrictionDistance {
    double had_m = 0.0;
    double max_m = 0.0;  ///< at the peak all the way
};
/// From one speed down to another on `rig.surface`, with the slip `slip_reference` at every instant, less at low speed as `config` has it: no
/// pressure build-up, no error of control.
[[nodiscard]] FrictionDistance held_distance(const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double slip_reference,
                                             double from_mps, double to_mps);

/// J_mu, eq. (16), of such a stop from `rig.brake_on_mps` to drop-out, 0 to 1.
[[nodiscard]] double held_j_mu(const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double slip_reference,
                               double drop_out_mps);

}  // namespace robust
