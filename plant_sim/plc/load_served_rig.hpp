/// From config/rig_machinery.toml to the options of a served rig.
#pragma once

#include <filesystem>

#include "plant_sim/plc/served_rig.hpp"

namespace plc {

enum class Bench {
    landing,    ///< Table II: the flywheel of the maneuver's mass
    endurance,  ///< Table III
};

/// The file in `directory`, e.g. for the hash of results.
[[nodiscard]] std::filesystem::path machinery_file(const std::filesystem::path& directory);

/// Machinery; everything else as ServedRigOptions has it. Throws settings::Error naming file, line and key.
[[nodiscard]] ServedRigOptions load_served_rig(const std::filesystem::path& directory, Bench bench);

}  // namespace plc
