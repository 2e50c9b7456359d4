/// Operating point of a linearisation: an equilibrium at one speed and one slip of a maneuver on a surface.
#pragma once

#include <vector>

#include "plant_sim/model/rig.hpp"

namespace study::margins {

/// Which pole the linearised wheel has. Both neglect the change of speed, load, radius and brake gain while the loop settles.
enum class Linearisation {
    printed,  ///< eq. (15): v constant, so that only the slope of mu counts
    full,     ///< d lambda' / d lambda with v, F_z and r frozen, v' not: eq. (15) and the term - mu (lambda)
};

/// An equilibrium: slip constant, lambda' = 0.
struct OperatingPoint {
    double speed_mps = 0.0;
    double slip = 0.0;
    double mass_kg = 0.0;
    double inertia_kgm2 = 0.0;
    double load_N = 0.0;         ///< F_z of eq. (2)
    double radius_m = 0.0;       ///< r(F_z)
    double brake_gain_m3 = 0.0;  ///< k_b of eq. (5) at this speed
    double mu = 0.0;
    double mu_1 = 0.0;               ///< d mu / d lambda
    double pressure_Pa = 0.0;        ///< pressure that holds the slip; may exceed the valve's full pressure
    double deceleration_mps2 = 0.0;  ///< F_x / m
    rig::RingParameters ring{};      ///< of the tyre; without a belt for a rigid one
    double relaxation_m = 0.0;       ///< sigma of compliance.hpp at this slip; 0: none

    /// Pole a of the rigid wheel, with any tyre, in G(s) = (r / (J v)) / (s + a); negative past the peak, where the wheel is unstable.
    [[nodiscard]] double wheel_pole_radps(Linearisation linearisation) const;
};

/// `speed_mps` > 0, 0 < `slip` <= 1. Load by eq. (2), brake as in `rig`.
[[nodiscard]] OperatingPoint operating_point(const rig::RigParameters& rig, double speed_mps, double slip);

/// `count` >= 2 speeds from `first_mps` down to `last_mps` with a constant ratio: the pole is proportional to 1/v.
[[nodiscard]] std::vector<double> speed_grid(double first_mps, double last_mps, int count);

}  // namespace study::margins
