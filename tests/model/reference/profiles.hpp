/// Brake pressures that a user would drive a stop with, relative to what the runway can take.
#pragma once

#include <vector>

#include "tests/model/reference/reference_plant.hpp"

struct NamedProfile {
    const char* name;
    reference::Profile pressure_Pa;
    double longest_s;
};

/// The least pressure between brake-on and 5 m/s (or half of brake-on) whose steady torque is that of the friction peak, eq. (1) with the slip held
/// there.
[[nodiscard]] double min_peak_pressure_Pa(const rig::RigParameters& rig);

/// Ramp and hold at 0.7 of the peak; triangles through 0.85 of it; steps to 1.6 of it, by which the wheel locks, and back to nothing, by
/// which it spins up again; random knots between 0 and 1.2 of it.
[[nodiscard]] std::vector<NamedProfile> profiles(const rig::RigParameters& rig);
