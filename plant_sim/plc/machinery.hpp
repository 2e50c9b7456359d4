/// Models of the machines that the PLC controls, each no more detailed than a maneuver needs: drive, sledge, loading device, brake temperature,
/// gauges. Their parameters are in config/rig_machinery.toml, read by load_served_rig.hpp.
#pragma once

#include <algorithm>
#include <cmath>

#include "plant_sim/model/drag.hpp"
#include "rig_bridge/rig/random.hpp"

namespace plc {

/// Speed control of the flywheel. It only accelerates: when off, and towards a lower set-point, the flywheel coasts.
struct Drive {
    double torque_Nm = 0.0;
    double power_W = 0.0;
    double speed_max_mps = 0.0;  ///< rim
    double response_s = 0.0;     ///< time constant near the set-point
    plant::Drag drag;            ///< acts with the wheel off the rim; eq. (1) has none

    /// Force at the rim towards `set_point_mps`, limited by torque and power. The drag is fed forward, so that the set-point is held without offset.
    [[nodiscard]] double force_N(double set_point_mps, double v_mps, double mass_kg, double radius_m) const {
        constexpr double kSlow_mps = 1e-3;
        const double wanted = drag.force_N(v_mps) + mass_kg / response_s * (set_point_mps - v_mps);
        const double limit = std::min(torque_Nm / radius_m, power_W / std::max(v_mps, kSlow_mps));
        return std::clamp(wanted, 0.0, limit);
    }
};

/// Moves the wheel to the rim and back at constant speed.
struct Sledge {
    double contact_m = 0.0;
    double speed_mps = 0.0;
    double wheel_drag_Nm = 0.0;  ///< on the wheel while it is off the rim

    [[nodiscard]] double moved(double position_m, bool advance, double h) const {
        return advance ? std::min(position_m + speed_mps * h, contact_m) : std::max(position_m - speed_mps * h, 0.0);
    }
};

struct LoadingDevice {
    double contact_force_N = 0.0;  ///< with the wheel on the rim and load not enabled
    double force_max_N = 0.0;
    double lift_max_Ns2pm2 = 0.0;
};

/// Temperature of the brake as one mass: C dT/dt = P - G (T - T_ambient); exact for a power that is constant over the step.
struct BrakeThermal {
    double heat_capacity_JpK = 0.0;
    double cooling_WpK = 0.0;
    double ambient_C = 0.0;

    [[nodiscard]] double decay(double h) const { return std::exp(-h * cooling_WpK / heat_capacity_JpK); }
    /// Temperature after a step with this `decay` in which the brake took `power_W`.
    [[nodiscard]] double after(double T_C, double power_W, double decay) const {
        const double end_C = ambient_C + power_W / cooling_WpK;
        return end_C + (T_C - end_C) * decay;
    }
    /// Time until an unheated brake has cooled from `T_C` to `to_C`: 0 if it is not hotter, infinite if `to_C` is not above ambient.
    [[nodiscard]] double cooling_time_s(double T_C, double to_C) const {
        if (T_C <= to_C) return 0.0;
        if (to_C <= ambient_C) return INFINITY;
        return heat_capacity_JpK / cooling_WpK * std::log((T_C - ambient_C) / (to_C - ambient_C));
    }
};

/// Noise and resolution of a measured quantity.
struct Gauge {
    double noise = 0.0;       ///< standard deviation
    double resolution = 0.0;  ///< > 0

    [[nodiscard]] double read(double value, rig::Random& random) const {
        return resolution * std::nearbyint((value + noise * random.noise()) / resolution);
    }
};

struct Gauges {
    Gauge force, torque, speed, temperature, hydraulics;
};

struct Hydraulics {
    double pressure_Pa = 0.0;
    double ready_Pa = 0.0;  ///< below it the interlock opens
};

struct Machinery {
    Drive drive;
    Sledge sledge;
    LoadingDevice loading;
    BrakeThermal thermal;
    Gauges gauges;
    Hydraulics hydraulics;
};

}  // namespace plc
