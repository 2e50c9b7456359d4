/// Summary of a maneuver: figures from its measured signals, and what was run. Content of summary.json and of a row of the ledger.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rig_bridge/record/specimen.hpp"

namespace rig::record {

/// From brake-on to standstill by the maneuver-state telemetry, computed from bus frames alone: rebuilding them from bus.log gives bit-identical
/// values.
struct Figures {
    double brake_on_mps = 0.0;  ///< rim speed at brake-on
    double duration_s = 0.0;
    double length_m = 0.0;        ///< on the rim
    double mean_torque_Nm = 0.0;  ///< time averages
    double mean_load_N = 0.0;
    double mean_pressure_Pa = 0.0;
    double mean_friction = 0.0;       ///< mu_b of eq. (7), down to drop-out
    double energy_brake_J = 0.0;      ///< eq. (9), measured torque and wheel speed
    double energy_tyre_J = 0.0;       ///< eq. (9), measured force, slip and speed
    double kinetic_energy_J = 0.0;    ///< eq. (8), from measured speed and the rig's inertias
    double j_mu = 0.0;                ///< eq. (16), F_x / F_z against the surface's peak, down to drop-out
    double peak_temperature_C = 0.0;  ///< of the brake, from brake-on to the end of the record
    bool standstill = false;
};

/// Warning: brake plus tyre energy differs from the kinetic energy lost.
inline constexpr std::string_view kEnergyUnbalanced = "energy_unbalanced";

/// Outcome of a maneuver aborted because its record could not be written.
inline constexpr std::string_view kRecordLost = "record_lost";

struct Summary {
    std::string campaign;     ///< name; empty for a single maneuver
    std::int64_t number = 0;  ///< of the maneuver in its campaign, from 1
    std::string scenario;
    Specimen specimen{};
    std::string outcome;               ///< "finished", or the name of the abort
    std::string started;               ///< wall clock, ISO 8601 UTC
    double cumulative_energy_J = 0.0;  ///< brake energy of the campaign, this maneuver's counted_energy_J() included
    Figures figures;
    std::vector<std::string> faults;  ///< the controller's, by name
    /// Figures of a finished maneuver outside the scenario's bands, by their keys; none: not judged.
    std::optional<std::vector<std::string>> out_of_tolerance;
    /// Problems of the record: name, then details. Empty for a valid one.
    std::vector<std::string> warnings;
    std::uint64_t frames = 0;          ///< recorded
    std::uint64_t frames_dropped = 0;  ///< dropped by the kernel before the recorder; missing in the figures
    std::uint64_t seed = 0;
    std::string version;
    std::string config_hash;
};

/// Whether it finished out of tolerance: its energy counts, its friction is not a point of the campaign.
[[nodiscard]] inline bool off_conditions(const Summary& summary) {
    return summary.out_of_tolerance && !summary.out_of_tolerance->empty();
}

/// Whether its energies do not balance: torque, speed or force is wrong somewhere.
[[nodiscard]] inline bool unbalanced(const Summary& summary) {
    for (const std::string& warning : summary.warnings)
        if (warning.starts_with(kEnergyUnbalanced)) return true;
    return false;
}

/// A maneuver's contribution to the cumulative energy, J: 0 if unknown, until a person enters it (Ledger::amend()).
[[nodiscard]] inline double counted_energy_J(const Summary& summary) {
    return unbalanced(summary) ? 0.0 : summary.figures.energy_brake_J;
}

}  // namespace rig::record
