/// Compliance between rim and aircraft: the tyre's carcass and the gear leg. Zero disables a part; without any, the tyre's force follows its slip at
/// once, as in the paper.
///
/// Sources of the ranges: R. F. Smiley, W. B. Horne, Mechanical properties of pneumatic tires, NACA TN 4110, 1958 (fore-and-aft stiffness,
/// relaxation lengths); J. A. Tanner, Fore-and-aft elastic response characteristics of 34 x 9.9, type VII, 14 ply-rating aircraft tires of
/// bias-ply design, NASA TN D-7449, 1974; H. B. Pacejka, Tire and Vehicle Dynamics, chapters 7 to 9 (relaxation, rigid ring).
#pragma once

namespace rig {

/// Rim and belt, joined by a spring and a damper about the axle. The rim carries the brake and the encoder, the belt the road force.
struct RingParameters {
    double belt_share = 0.0;    ///< of J_w that is belt, 0 (rigid) to below 1; 0.25 to 0.45 for a wheel with its brake
    double frequency_Hz = 0.0;  ///< rim against belt, wheel off the ground; 50 to 120
    double damping = 0.0;       ///< of that mode, of critical; 0.03 to 0.10
};

/// The slip that makes the force follows eq. (3) over a distance: sigma d lambda'/dt = (v - omega r) - v lambda', F_x = F_z mu(lambda').
/// sigma is the slope of mu over its slope at zero slip, times `length_m`: carcass stiffness is a constant, the tread's is not.
struct RelaxationParameters {
    double length_m = 0.0;  ///< sigma at no slip, 0 (none) to 1; 0.03 to 0.6
    double floor_m = 0.02;  ///< lower limit of sigma; equal to `length_m`: sigma is constant
};

/// The leg bends fore and aft: axle and aircraft have different speeds, and eq. (3) uses the axle's.
struct LegParameters {
    double mass_kg = 0.0;       ///< that moves with the axle, part of the mass on the wheel; 0: rigid
    double frequency_Hz = 0.0;  ///< of that mass on the leg, aircraft held; 8 to 20
    double damping = 0.0;       ///< of critical; 0.02 to 0.10
};

struct Compliance {
    RingParameters ring;
    RelaxationParameters relaxation;
    LegParameters leg;

    [[nodiscard]] bool any() const { return ring.belt_share > 0.0 || relaxation.length_m > 0.0 || leg.mass_kg > 0.0; }
};

}  // namespace rig
