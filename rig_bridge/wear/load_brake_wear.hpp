/// From `[brake.wear]` of a rig's configuration to the wear of its brake.
#pragma once

#include <filesystem>

#include "firmware/host/settings/settings.hpp"
#include "rig_bridge/wear/wearing_brake.hpp"

namespace wear {

/// Keys: `model` (a file of model_io.hpp, relative to `directory`), `energy_scale`, `friction_scale`, `life_J`; all of them must be there. The table
/// `law`, with every member of LiningLaw, may be.
/// Throws settings::Error naming file, line and key, and where the model's own file is wrong.
[[nodiscard]] BrakeWear load_brake_wear(const settings::Table& brake_wear, const std::filesystem::path& directory);

}  // namespace wear
