/// Estimates made by hand, for the laws by themselves.
#pragma once

#include "firmware/control/estimate.hpp"
#include "tests/control/fixed_config.hpp"

namespace control_test {

inline constexpr float kFull_Pa = 20.7e6F;

/// A wheel at `slip` and `v_mps`, at rest in its slip: pressure and road torque in balance, now and after the delay.
[[nodiscard]] inline antiskid::control::Estimate balanced(const float v_mps, const float slip, const float pressure_Pa) {
    const antiskid::control::Config c = fixed_config();
    antiskid::control::Estimate e;
    e.speeds_known = true;
    e.v_mps = v_mps;
    e.v_dot_mps2 = 0.0F;
    e.radius_m = 0.32F;
    e.omega_radps = v_mps * (1.0F - slip) / e.radius_m;
    e.slip = slip;
    e.pressure.pressure_Pa = pressure_Pa;
    e.brake_gain = c.wheel.brake_gain_m3 / c.wheel.inertia_kgm2;
    e.late_v_mps = v_mps;
    e.late_slip = slip;
    e.late_pressure = e.pressure;
    e.late_balance_Pa = pressure_Pa;
    return e;
}

/// lambda_dot per pressure, from eq. (1b) and (3): r k_b / (J v).
[[nodiscard]] inline double rate_per_Pa(const antiskid::control::Estimate& e) {
    return static_cast<double>(e.radius_m) * (1.04e-3 / 1.3) / static_cast<double>(e.late_v_mps);
}

}  // namespace control_test
