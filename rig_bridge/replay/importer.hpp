/// A continuous recording of another system, cut into maneuvers by its own signals and written as folders like the bridge's:
/// DIR/0001/bus.log and summary.json, DIR/0002/...
///
/// The recording is read twice: first every channel is surveyed, and a unit that cannot be right ends the import before
/// anything is written. CSV is streamed in constant memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "rig_bridge/replay/import_map.hpp"
#include "rig_bridge/replay/import_notes.hpp"
#include "rig_bridge/replay/maneuver_writer.hpp"
#include "rig_bridge/replay/recording.hpp"

namespace rig::replay {

struct ImportSettings {
    std::filesystem::path file;
    ImportMap map;
    std::filesystem::path out;
    ImportedRig rig;
    record::Specimen specimen{};  ///< of every maneuver in it
    std::string config_hash;
};

struct ImportedManeuver {
    std::filesystem::path folder;
    std::string outcome;  ///< "finished", "released" before standstill, or "recording_broken" (gap, time reset, end of file)
    std::uint64_t first_row = 0;
    record::Figures figures;
};

struct ImportReport {
    std::uint64_t rows = 0;
    std::vector<ImportedManeuver> maneuvers;
};

/// Throws std::invalid_argument for a text of the specimen that is none (check_texts()), std::runtime_error when the file cannot be read, a unit
/// cannot be right (naming column, values and likely unit), or `out` holds maneuvers already.
[[nodiscard]] ImportReport import_recording(const ImportSettings& settings, ImportNotes& notes);

}  // namespace rig::replay
