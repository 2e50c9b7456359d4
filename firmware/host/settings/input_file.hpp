/// Whole small files in memory.
#pragma once

#include <filesystem>
#include <string>

#include "firmware/host/settings/error.hpp"

namespace settings {

/// The bytes of a file. Error when it is absent, a directory, unreadable, or above 16 MiB (no settings file
/// is).
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

}  // namespace settings
