/// What a recording says of the valve: the current that was commanded and the pressure that came of it, with the wheel at rest.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "plant_sim/study/identification/recording.hpp"

namespace identification {

/// The part of a recording that counts, on a grid of periods. The current is followed from the start of braking, so that the valve's state at
/// standstill is known; pressures count at standstill only.
struct ValveExperiment {
    std::string name;
    double period_s = 0.0;
    double start_s = 0.0;
    std::vector<double> current_mA;
    std::vector<double> pressure_Pa;
    std::vector<std::uint8_t> measured;  ///< false where samples were missing
};

/// Whether the rig stood long enough while it was recorded.
[[nodiscard]] bool shows_valve(const Recording& recording);

/// Throws NotIdentifiable where samples are missing for more than 50 ms.
[[nodiscard]] ValveExperiment valve_experiment(const Recording& recording);

/// Throws NotIdentifiable where the gauge saturates, or the current leaves the map that is wanted.
void check_range(const ValveExperiment& experiment, const KnownRig& rig);

/// Throws NotIdentifiable where the current does not move fast above the dead zone.
void check_dynamics(std::span<const ValveExperiment> experiments, double dead_zone_mA);

/// What rising and falling ramps say of the static map, without regard to the lag: pressures, Pa, at rig.map_currents; a start for a fit. Throws
/// NotIdentifiable where a point of the map has not been passed both ways. The first point, of no pressure, and the last, where a ramp turns,
/// need one way.
[[nodiscard]] std::vector<double> ramp_pressures_Pa(std::span<const ValveExperiment> experiments, const KnownRig& rig);

}  // namespace identification
