/// Loads the parameters of one maneuver on one rig from the files in config/.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rig_bridge/rig/rig_parameters.hpp"
#include "rig_bridge/wear/wearing_brake.hpp"

namespace rig {

/// What carries the wheel.
enum class Carrier {
    aircraft,  ///< landing: F_z follows eq. (2) at once
    flywheel,  ///< the same maneuver on a flywheel of equal inertia, J_f = m R_f^2: the loading device lags behind eq. (2)
};

/// The name of the flywheel rig's own maneuver, Table III, beside those of config/maneuvers.toml.
inline constexpr const char* kEndurance = "endurance";

struct ManeuverChoice {
    std::string maneuver = "heavy";       ///< a table of config/maneuvers.toml, or `endurance` (config/flywheel_rig.toml)
    std::string surface = "dry_asphalt";  ///< a table of config/surfaces.toml
    std::filesystem::path runway;         ///< a file for load_runway(), replaces `surface`; empty: none
    Carrier carrier = Carrier::aircraft;  ///< `endurance` is always on the flywheel
    std::optional<double> mass_kg;        ///< instead of the maneuver's
    std::optional<double> speed_mps;
    std::optional<double> friction;  ///< mean mu_b instead of the new brake's
    /// A TOML file with [brake.relative_friction], as `rig-lab wear dynamics` writes it; its classes replace those of the rig. Empty: none.
    std::filesystem::path friction_curves;

    /// Name of the surface, or of the runway's file without extension.
    [[nodiscard]] std::string road() const { return runway.empty() ? surface : runway.stem().string(); }
};

struct LoadedRig {
    RigParameters rig;
    double drop_out_mps = 0.0;                 ///< end of eq. (16)
    double full_pressure_Pa = 0.0;             ///< largest pressure of the valve: a full demand
    double deceleration_mps2 = 0.0;            ///< prescribed for `endurance`, else 0
    std::string friction_class;                ///< class of the maneuver, selects its curve of mu_b
    wear::BrakeWear wear;                      ///< of this rig's brake
    std::vector<std::filesystem::path> files;  ///< files that were read, for the hash of results
};

/// Reads `directory`/*.toml. Throws settings::Error naming file, line and key; for an unknown maneuver or surface the text lists the known ones.
[[nodiscard]] LoadedRig load_rig(const std::filesystem::path& directory, const ManeuverChoice& choice);

/// light, medium, heavy: the keys of [brake.relative_friction].
[[nodiscard]] std::vector<std::string> friction_class_names();

/// Names in file order.
[[nodiscard]] std::vector<std::string> surface_names(const std::filesystem::path& directory);
[[nodiscard]] std::vector<std::string> maneuver_names(const std::filesystem::path& directory);

}  // namespace rig
