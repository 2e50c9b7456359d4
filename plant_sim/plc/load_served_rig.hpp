/// Reads the options of a served rig from config/rig_machinery.toml.
#pragma once

#include <filesystem>

#include "plant_sim/plc/served_rig.hpp"

namespace plc {

enum class Bench {
    landing,    ///< Table II: the flywheel of the maneuver's mass
    endurance,  ///< Table III
};

/// Path of the file in `directory`, e.g. for the hash of results.
[[nodiscard]] std::filesystem::path machinery_file(const std::filesystem::path& directory);

/// Reads the machinery; all other members have their defaults. Throws settings::Error naming file, line and key.
[[nodiscard]] ServedRigOptions load_served_rig(const std::filesystem::path& directory, Bench bench);

}  // namespace plc
