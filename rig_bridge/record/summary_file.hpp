/// Reads and writes summary.json, and prints it for people.
#pragma once

#include <filesystem>
#include <string>

#include "firmware/host/settings/storage.hpp"
#include "rig_bridge/record/summary.hpp"

namespace rig::record {

/// Written atomically (settings::write_file); doubles are read back bit-identical. Throws settings::Error.
void write_summary(const std::filesystem::path& path, const Summary& summary, const settings::Storage& storage = settings::PosixStorage{});

/// Throws settings::Error naming file and key if the file is missing or not JSON, or a key is missing, unknown or of the wrong type.
[[nodiscard]] Summary read_summary(const std::filesystem::path& path, const settings::Storage& storage = settings::PosixStorage{});

/// A line for every figure, with units.
[[nodiscard]] std::string summary_table(const Summary& summary);

}  // namespace rig::record
