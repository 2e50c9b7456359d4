/// What a slip reference offers on one surface, held exactly.
#pragma once

#include "firmware/control/config.hpp"
#include "plant_sim/model/rig.hpp"

namespace robust {

/// J_mu, eq. (16), of a stop from `rig.brake_on_mps` to drop-out on `rig.surface` whose slip is `slip_reference` at every instant, less at low
/// speed as `config` has it: no pressure build-up, no error of control, 0 to 1.
[[nodiscard]] double held_j_mu(const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double slip_reference,
                               double drop_out_mps);

}  // namespace robust
