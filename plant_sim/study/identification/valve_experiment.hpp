/// Valve data of a recording: commanded current and resulting pressure, with the wheel at rest.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "plant_sim/study/identification/recording.hpp"

namespace identification {

/// The relevant part of a recording, sampled once a period. The current is followed from the beginning of braking, so that the valve's state at
/// standstill is known; only pressures at standstill are used.
struct ValveExperiment {
    std::string name;
    double period_s = 0.0;
    double start_s = 0.0;
    std::vector<double> current_mA;
    std::vector<double> pressure_Pa;
    std::vector<std::uint8_t> measured;  ///< false: the sample is missing
};

/// Whether the recording has a standstill that is long enough.
[[nodiscard]] bool shows_valve(const Recording& recording);

/// Throws NotIdentifiable if samples are missing for more than 50 ms.
[[nodiscard]] ValveExperiment valve_experiment(const Recording& recording);

/// Throws NotIdentifiable if the gauge saturates, or the current leaves the range of the requested map.
void check_range(const ValveExperiment& experiment, const KnownRig& rig);

/// Throws NotIdentifiable if the current does not change fast above the dead zone.
void check_dynamics(std::span<const ValveExperiment> experiments, double dead_zone_mA);

/// Static map from rising and falling ramps without regard to the lag: pressures, Pa, at rig.map_currents, as start of a fit. Throws NotIdentifiable
/// if a point of the map was not passed in both directions; for the first point, without pressure, and the last, at which a ramp turns, one direction
/// is enough.
[[nodiscard]] std::vector<double> ramp_pressures_Pa(std::span<const ValveExperiment> experiments, const KnownRig& rig);

}  // namespace identification
