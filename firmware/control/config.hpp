/// Every number of the controller. Loaded and range-checked from config/controller.toml by the programs; a microcontroller compiles it in.
/// The controller trusts these values: whoever fills the struct validates it. Ranges and sources stand in config/controller.toml.
#pragma once

#include <array>
#include <cstdint>

namespace antiskid::control {

/// A toothed encoder and what its speed may plausibly do.
struct EncoderConfig {
    float teeth = 0.0F;
    float max_speed_radps = 0.0F;
    float max_acceleration_radps2 = 0.0F;  ///< above this between two frames the reading is implausible
};

/// Rolling radius r(F_z) = r_0 - F_z / k_r with eq. (2): a free-rolling wheel before brake-on calibrates it, lift carries it on.
struct WheelConfig {
    EncoderConfig encoder;
    float inertia_kgm2 = 0.0F;            ///< J_w
    float nominal_radius_m = 0.0F;        ///< used until the wheel has rolled freely
    float radius_tolerance = 0.0F;        ///< calibrated radius stays within this fraction of the nominal one
    float stiffness_Npm = 0.0F;           ///< k_r
    float lift_Ns2pm2 = 0.0F;             ///< rho S C_l / 2 of eq. (2)
    float brake_gain_m3 = 0.0F;           ///< nominal k_b
};

struct FlywheelConfig {
    EncoderConfig encoder;
    float radius_m = 0.0F;  ///< R_f
};

struct ValveConfig {
    static constexpr std::size_t kMostPoints = 16;
    std::uint8_t points = 0;  ///< points in use, 2 to 16
    std::array<float, kMostPoints> current_mA{};   ///< strictly increasing
    std::array<float, kMostPoints> pressure_Pa{};  ///< strictly increasing
    float natural_frequency_radps = 0.0F;          ///< omega_n, eq. (6)
    float damping = 0.0F;                          ///< xi
    float delay_s = 0.0F;                          ///< tau, at most 16 periods
    float safe_current_mA = 0.0F;                  ///< no pressure
    float full_pressure_Pa = 0.0F;
};

/// Bandwidths of the estimators, rad/s.
struct EstimatorConfig {
    float aircraft_bandwidth_radps = 0.0F;  ///< speed and deceleration from the flywheel encoder
    float wheel_bandwidth_radps = 0.0F;     ///< wheel speed and road torque
    float pressure_bandwidth_radps = 0.0F;  ///< correction of the valve model by the transducer
};

/// PID on predicted slip. Gains act on slip rate (1/s): the law multiplies by J v / (r k_b), which is the schedule with speed.
struct SlipConfig {
    float k_p_per_s = 0.0F;
    float k_i_per_s2 = 0.0F;
    float k_d = 0.0F;        ///< on the slip rate
    float k_dd_s = 0.0F;     ///< on the rate of the slip rate, which the valve model gives without differentiation
    float road_torque_share = 0.0F;  ///< feed-forward of the observed road torque, 0 (off) to 1
    float build_up_slip = 0.0F;      ///< the valve is overdriven at brake-on until the predicted slip passes this share of the reference
    float build_up_pressure_Pa = 0.0F;  ///< added to the pressure that balances the road while building up
    float reference_rate_per_s = 0.0F;  ///< the reference in force follows a change at this rate
    float low_speed_mps = 0.0F;      ///< below it the reference falls with speed; 0: the paper's exact law
    float low_speed_floor_mps = 0.0F;  ///< at and below it the reference is `low_speed_slip` at the most
    float low_speed_slip = 0.0F;
};

}  // namespace antiskid::control
