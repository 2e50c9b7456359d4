/// What is thought of the brake after a maneuver, as the ledger keeps it. Who thinks so is not the ledger's business.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>

namespace rig::record {

/// unknown: nobody judges, or too few maneuvers yet. suspect: out of the ordinary, and may go away. abnormal: not a brake like those that
/// the wear model knows.
enum class HealthState : std::uint8_t { unknown, healthy, suspect, abnormal };

inline constexpr std::array kHealthNames{"unknown", "healthy", "suspect", "abnormal"};

[[nodiscard]] constexpr const char* name(HealthState state) {
    return kHealthNames.at(static_cast<std::size_t>(state));
}

struct Health {
    HealthState state = HealthState::unknown;
    /// The greatest of the monitor's tests, each as share of the limit at which the brake is called abnormal; NaN while unknown.
    double statistic = std::numeric_limits<double>::quiet_NaN();
    std::string reason;  ///< for people; empty while healthy
    std::string model;   ///< hash of the wear model that judged; empty: none
};

}  // namespace rig::record
