/// Reads config/controller.toml into the controller's configuration, with every value checked against its
/// range.
#pragma once

#include <filesystem>

#include "firmware/control/config.hpp"

namespace antiskid {

/// Throws settings::Error naming file, line and key.
[[nodiscard]] control::Config load_controller_config(const std::filesystem::path& path);

}  // namespace antiskid
