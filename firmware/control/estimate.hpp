/// Estimated state of wheel, aircraft and brake: now, and predicted for when a command takes effect (`late_`).
#pragma once

#include "firmware/control/valve_model.hpp"

namespace antiskid::control {

struct Estimate {
    bool speeds_known = false;  ///< both encoders have shown a speed or a standstill
    float v_mps = 0.0F;         ///< aircraft (rim) speed
    float v_dot_mps2 = 0.0F;
    float omega_radps = 0.0F;  ///< wheel speed
    float omega_dot_radps2 = 0.0F;
    float radius_m = 0.0F;   ///< rolling radius now
    float slip = 0.0F;       ///< eq. (3), now; 0 at standstill
    PressureState pressure;  ///< now

    float brake_gain = 0.0F;                  ///< k_b / J_w: wheel deceleration per pressure
    float wheel_pole_radps = 0.0F;            ///< positive: stable, wheel_observer.hpp
    float wheel_pole_variance_radps2 = 0.0F;  ///< by the observer
    float road_radps2 = 0.0F;                 ///< the road's torque as wheel acceleration: r F_x / J_w
    bool another_road = false;                ///< detected in this step
    float late_v_mps = 0.0F;                  ///< predicted for after the valve's delay, from commands already given
    float late_slip = 0.0F;
    PressureState late_pressure;
    float late_balance_Pa = 0.0F;  ///< pressure at which the wheel would keep its slip
};

}  // namespace antiskid::control
