/// Whole small files in memory.
#pragma once

#include <filesystem>
#include <string>

#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/storage.hpp"

namespace settings {

/// No settings file is larger.
inline constexpr std::size_t kMaxSettings = 16U << 20U;
/// The bytes of a file. Error when it is absent, a directory, unreadable, or larger than `most`.
[[nodiscard]] std::string read_file(const std::filesystem::path& path, std::size_t max = kMaxSettings, const Storage& storage = PosixStorage{});

}  // namespace settings
