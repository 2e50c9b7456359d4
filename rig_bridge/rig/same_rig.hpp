/// Numbers that the rig's files and the controller's both have, because controller and rig are separate computers.
#pragma once

#include <filesystem>

#include "firmware/control/config.hpp"
#include "rig_bridge/rig/load_rig.hpp"

namespace rig {

/// Teeth of both encoders and the flywheel's radius: with other ones both speeds scale alike, the slip stays right and nothing shows it. Throws
/// settings::Error naming `controller_file` and the key.
void check_same_rig(const LoadedRig& loaded, const antiskid::control::Config& controller, const std::filesystem::path& controller_file);

}  // namespace rig
