/// Reads a brake's wear from `[brake.wear]` of a rig's configuration.
#pragma once

#include <filesystem>

#include "firmware/host/settings/settings.hpp"
#include "rig_bridge/wear/wearing_brake.hpp"

namespace wear {

/// Keys: `model` (a file of model_io.hpp, relative to `directory`), `energy_scale`, `friction_scale`, `life_J`; all required. The table `law`, with
/// every member of LiningLaw, is optional. Throws settings::Error naming file, line and key, also for an error in the model's file.
[[nodiscard]] BrakeWear load_brake_wear(const settings::Table& brake_wear, const std::filesystem::path& directory);

}  // namespace wear
