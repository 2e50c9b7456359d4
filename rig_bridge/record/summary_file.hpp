/// summary.json of a maneuver's folder, and the same for people.
#pragma once

#include <filesystem>
#include <string>

#include "firmware/host/settings/storage.hpp"
#include "rig_bridge/record/summary.hpp"

namespace rig::record {

/// Whole or not at all (settings::write_file). Every double comes back with the same bits. Throws settings::Error.
void write_summary(const std::filesystem::path& path, const Summary& summary, const settings::Storage& storage = settings::PosixStorage{});

/// Throws settings::Error naming file and key: not there, no JSON, a key missing, unknown or of another type.
[[nodiscard]] Summary read_summary(const std::filesystem::path& path, const settings::Storage& storage = settings::PosixStorage{});

/// A line for every figure, with units.
[[nodiscard]] std::string summary_table(const Summary& summary);

}  // namespace rig::record
