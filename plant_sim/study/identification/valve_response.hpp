/// Pressure of the valve of eq. (6) for a recorded current.
#pragma once

#include <span>

#include "plant_sim/model/valve.hpp"

namespace identification {

/// `current_mA[k]` acts from period k to k + 1; `pressure_Pa[k]` is the pressure at period k. Starts without pressure and rate. A negative hysteresis
/// exchanges the branches, so that a fit can pass through zero.
void valve_response(std::span<const double> current_mA, double period_s, const rig::PressureMap& map, const rig::ValveParameters& valve,
                    std::span<double> pressure_Pa);

}  // namespace identification
