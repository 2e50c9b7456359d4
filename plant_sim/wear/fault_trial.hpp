/// How soon abnormal brakes are flagged, and how often healthy ones are: measured on campaigns of healthy brakes, into which faults are put.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "rig_bridge/wear/health.hpp"

namespace wear {

enum class Fault : std::uint8_t {
    glazing,  ///< friction is lost by `size` (a share) over kGlazingManeuvers, evenly, and stays lost
    drop,     ///< lost by `size` from one maneuver to the next
    drag,     ///< a piston sticks: eq. (7) has a share `size` of torque more than pressure explains, from one maneuver to the next
};
constexpr std::size_t kGlazingManeuvers = 40;

/// The campaign with a fault from maneuver `begin` (counted from 0) on.
[[nodiscard]] Campaign with_fault(const Campaign& healthy, Fault fault, double size, std::size_t begin);

struct HealthyTrial {
    std::size_t campaigns = 0;
    std::size_t maneuvers = 0;
    std::size_t flagged = 0;  ///< campaigns called abnormal
    std::size_t suspected_maneuvers = 0;
};

struct FaultTrial {
    Fault fault = Fault::glazing;
    double size = 0.0;
    std::size_t campaigns = 0;  ///< with the fault, those aside that were flagged before it began
    std::size_t flagged = 0;    ///< before they ended
    /// Maneuvers from the fault's begin to the flag, the flagged one counted; 50 and 90 % of all campaigns, 0 where fewer were flagged.
    std::size_t median = 0;
    std::size_t ninety = 0;
};

[[nodiscard]] HealthyTrial try_healthy(const Population& population, const std::vector<Campaign>& healthy);

/// The fault begins between 20 and 70 % of each campaign, drawn by `seed`.
[[nodiscard]] FaultTrial try_fault(const Population& population, const std::vector<Campaign>& healthy, Fault fault, double size, std::uint64_t seed);

[[nodiscard]] const char* name(Fault fault);

}  // namespace wear
