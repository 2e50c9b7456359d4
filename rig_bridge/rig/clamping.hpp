/// What a brake has between pressure and torque that eq. (5), T_b = k_b P_b, leaves out. Zero disables a part; without any, torque is in proportion
/// to pressure, as in the paper.
#pragma once

#include <algorithm>

namespace rig {

struct Clamping {
    double contact_Pa = 0.0;       ///< return springs hold the discs apart below this pressure, and take it off above
    double piston_friction = 0.0;  ///< of seals and keys, share of the pressure, 0 to below 1: the force lags by it in both directions
    double run_out = 0.0;          ///< amplitude of the torque's change once a turn, relative: discs that are not true; 0 to below 1
    double warp = 0.0;             ///< twice a turn: discs that are not flat; with run_out below 1

    /// What is left of the pressure to clamp the discs.
    [[nodiscard]] double net_Pa(double pressure_Pa) const { return std::max(pressure_Pa - contact_Pa, 0.0); }
    [[nodiscard]] bool any() const { return contact_Pa > 0.0 || piston_friction > 0.0 || run_out > 0.0 || warp > 0.0; }
};

}  // namespace rig
