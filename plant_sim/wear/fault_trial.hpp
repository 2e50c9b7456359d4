/// Delay until abnormal brakes are flagged, and false alarms on healthy ones: healthy campaigns, with and without an added fault.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "rig_bridge/wear/health.hpp"

namespace wear {

enum class BrakeFault : std::uint8_t {
    glazing,  ///< friction decreases by `size` (a share) evenly over kGlazingManeuvers, permanently
    drop,     ///< decreases by `size` from one maneuver to the next
    drag,     ///< a piston sticks: from one maneuver to the next, eq. (7) contains a share `size` of torque that is not from pressure
};
constexpr std::size_t kGlazingManeuvers = 40;

/// Returns the campaign with a fault from maneuver `begin` on, counted from 0.
[[nodiscard]] Campaign with_fault(const Campaign& healthy, BrakeFault fault, double size, std::size_t begin);

/// Number of the maneuver, from 0, after which the brake is abnormal; that of its maneuvers where it never is.
[[nodiscard]] std::size_t flagged_at(const Population& population, const Campaign& campaign);

struct HealthyTrial {
    std::size_t campaigns = 0;
    std::size_t maneuvers = 0;
    std::size_t flagged = 0;  ///< number of campaigns classified as abnormal
    std::size_t suspected_maneuvers = 0;
};

struct FaultTrial {
    BrakeFault fault = BrakeFault::glazing;
    double size = 0.0;
    std::size_t campaigns = 0;  ///< number with the fault, without those flagged before it began
    std::size_t flagged = 0;    ///< number flagged before their end
    /// Maneuvers from the fault's beginning up to and including the flagged one: 50 and 90 % of all campaigns; 0 if fewer were flagged.
    std::size_t median = 0;
    std::size_t ninety = 0;
};

[[nodiscard]] HealthyTrial try_healthy(const Population& population, const std::vector<Campaign>& healthy);

/// The fault begins between 20 and 70 % of each campaign, drawn by `seed`.
[[nodiscard]] FaultTrial try_fault(const Population& population, const std::vector<Campaign>& healthy, BrakeFault fault, double size,
                                   std::uint64_t seed);

[[nodiscard]] const char* name(BrakeFault fault);

}  // namespace wear
