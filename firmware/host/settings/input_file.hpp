/// Reads a whole small file into memory.
#pragma once

#include <filesystem>
#include <string>

#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/storage.hpp"

namespace settings {

/// Limit for settings files, bytes.
inline constexpr std::size_t kMaxSettings = 16U << 20U;
/// Throws Error if the file is missing, a directory, unreadable, or larger than `max` bytes.
[[nodiscard]] std::string read_file(const std::filesystem::path& path, std::size_t max = kMaxSettings, const Storage& storage = PosixStorage{});

}  // namespace settings
