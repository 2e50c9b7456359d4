/// What a brake has between pressure and torque that eq. (5), T_b = k_b P_b, leaves out. Zero disables a part; without any, torque is in proportion
/// to pressure, as in the paper.
#pragma once

namespace rig {

struct Clamping {
    double contact_Pa = 0.0;  ///< the return springs hold the discs apart below this pressure, and take it off what clamps them above
    double piston_friction =
        0.0;               ///< of seals and keys, as share of the pressure, 0 to below 1: the force on the discs lags by as much in both directions
    double run_out = 0.0;  ///< amplitude of the torque's change once a turn of the wheel, relative: discs that are not true; 0 to below 1
    double warp = 0.0;     ///< twice a turn: discs that are not flat; 0 to below 1

    [[nodiscard]] bool any() const { return contact_Pa > 0.0 || piston_friction > 0.0 || run_out > 0.0 || warp > 0.0; }
};

}  // namespace rig
