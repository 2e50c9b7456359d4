/// Valve and wheel as a controller with a period sees them.
#pragma once

#include <Eigen/Core>

#include "firmware/control/config.hpp"
#include "plant_sim/model/rig.hpp"
#include "plant_sim/study/margins/linear_wheel.hpp"

namespace study::margins {

/// Over one period: pressure and its rate, the wheel's state of linear_wheel.hpp, the integral of the rim's slip since the period began.
struct SampledPlant {
    Eigen::MatrixXd phi;
    Eigen::VectorXd old_input, new_input;  ///< of the command before and after the broken part of the delay
};

/// `per_pressure`: q of `wheel` per unit of pressure; `per_command`: pressure per unit of command; `broken_s`: of the delay, beyond
/// whole periods.
[[nodiscard]] SampledPlant sampled_plant(const rig::ValveParameters& valve, const LinearWheel& wheel, double per_pressure, double per_command,
                                         double period_s, double broken_s);

/// Gain of the plant's valve over the one that the controller divides by, at a pressure.
[[nodiscard]] double valve_gain(const antiskid::control::ValveConfig& believed, const rig::PressureMap& map, double pressure_Pa);

}  // namespace study::margins
