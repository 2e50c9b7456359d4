/// Health of the brake after a maneuver, as stored in the ledger.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>

namespace rig::record {

/// unknown: no monitor, or too few maneuvers. suspect: unusual, may be temporary. abnormal: unlike the brakes in the wear model.
enum class HealthState : std::uint8_t { unknown, healthy, suspect, abnormal };

inline constexpr std::array kHealthNames{"unknown", "healthy", "suspect", "abnormal"};

[[nodiscard]] constexpr const char* name(HealthState state) {
    return kHealthNames.at(static_cast<std::size_t>(state));
}

struct Health {
    HealthState state = HealthState::unknown;
    /// Largest test statistic of the monitor, as share of the limit for `abnormal`; NaN while unknown.
    double statistic = std::numeric_limits<double>::quiet_NaN();
    std::string reason;  ///< for people; empty while healthy
    std::string model;   ///< hash of the wear model used; empty: none
};

}  // namespace rig::record
