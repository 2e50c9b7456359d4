/// The pressure that the valve of eq. (6) gives for a recorded current.
#pragma once

#include <span>
#include <vector>

#include "plant_sim/model/valve.hpp"

namespace identification {

/// `current_mA[k]` acts from k to k + 1 periods; the pressure is that at k periods. Starts without pressure or flow. A negative hysteresis is
/// the branches changed over, so that a fit may pass through zero.
void valve_response(std::span<const double> current_mA, double period_s, const rig::PressureMap& map, const rig::ValveParameters& valve,
                    std::span<double> pressure_Pa);

}  // namespace identification
