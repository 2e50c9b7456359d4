/// Parameters of a rig: wheel, load, brake, valve and sensors.
#pragma once

#include "rig_bridge/rig/clamping.hpp"
#include "rig_bridge/rig/compliance.hpp"
#include "rig_bridge/rig/friction_curve.hpp"
#include "rig_bridge/rig/pressure_map.hpp"
#include "rig_bridge/rig/runway.hpp"

namespace rig {

struct BrakeGeometry {
    double piston_area_m2 = 0.0;      ///< A_p
    double pistons = 0.0;             ///< N_p
    double surfaces = 0.0;            ///< N_s
    double effective_radius_m = 0.0;  ///< R_eff

    /// k_b per unit of friction, m^3.
    [[nodiscard]] double gain_m3() const { return piston_area_m2 * pistons * surfaces * effective_radius_m; }
};

struct EncoderParameters {
    double teeth = 60.0;
    double jitter_s = 0.0;         ///< standard deviation of an edge's time stamp
    double slowest_edges_hz = 10;  ///< a magnetic pick-up has no signal below this rate
    double pitch_error = 0.0;      ///< largest error of a tooth's position, as share of the pitch; uniform, constant for each tooth
    double eccentricity = 0.0;     ///< of the toothed ring: largest relative error of the measured speed within a turn
};

struct TransducerParameters {
    double range_Pa = 0.0;       ///< reads 0 to range
    double noise_Pa = 0.0;       ///< standard deviation
    double resolution_Pa = 0.0;  ///< of its converter; 0: continuous
};

struct ValveParameters {
    double natural_frequency_radps = 0.0;  ///< omega_n
    double damping = 0.0;                  ///< xi, in (0, 1)
    double delay_s = 0.0;                  ///< tau
    double hysteresis_mA = 0.0;            ///< width of the Play before the static map, >= 0
    double line_s = 0.0;                   ///< of the line between valve and brake: first-order lag, >= 0; 0: none, to the last bit
};

struct WheelParameters {
    double mass_kg = 0.0;        ///< m_a, or J_f / R_f^2
    double inertia_kgm2 = 0.0;   ///< J_w
    double free_radius_m = 0.0;  ///< r_0 of r(F_z) = r_0 - F_z / k_r
    double stiffness_Npm = 0.0;  ///< k_r
    Compliance compliance{};     ///< of tyre and leg; none: Wheel, otherwise CompliantWheel
};

/// The vertical load.
struct LoadParameters {
    double base_N = 0.0;       ///< m g of eq. (2), or the set-point of the loading device
    double lift_Ns2pm2 = 0.0;  ///< rho S C_l / 2 of eq. (2)
    double lag_s = 0.0;        ///< first-order lag of the loading device behind the law above; 0: the aircraft itself
};

struct RigParameters {
    WheelParameters wheel;
    LoadParameters load;
    BrakeGeometry brake;
    Clamping clamping{};
    FrictionCurve friction_curve{};
    double mean_friction = 0.0;  ///< mean mu_b of the maneuver
    ValveParameters valve;
    PressureMap pressure_map;
    EncoderParameters wheel_encoder;
    EncoderParameters flywheel_encoder;
    double flywheel_radius_m = 0.0;  ///< R_f of the wheel that measures v
    TransducerParameters transducer;
    Surface surface;  ///< of the whole runway, or where `runway` has no patch
    Runway runway{};
    double brake_on_mps = 0.0;   ///< speed of the maneuver
    double touchdown_mps = 0.0;  ///< initial speed, if spinning up the wheel reduces it; 0: brake_on_mps
};

}  // namespace rig
