/// Imports a continuous recording of another system: splits it into maneuvers by its signals and writes folders like the bridge's: DIR/0001/bus.log
/// and summary.json, DIR/0002/...
///
/// The recording is read twice: the first pass checks every channel, and an impossible unit ends the import before anything is written. CSV and logs
/// of frames are streamed in constant memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "rig_bridge/replay/import_map.hpp"
#include "rig_bridge/replay/maneuver_writer.hpp"
#include "rig_bridge/replay/recording.hpp"

namespace rig::replay {

/// Problems in a recording, with their place; all are counted, the first few of each kind are reported.
class ImportNotes {
  public:
    using Sink = std::function<void(const std::string&)>;
    ImportNotes(std::string file, Sink sink) : file_(std::move(file)), sink_(std::move(sink)) {}

    void add(const std::string& kind, std::uint64_t row, const std::string& text) {
        constexpr std::uint64_t kSaid = 5;
        const std::uint64_t n = ++counts_[kind];
        if (n > kSaid || !sink_) return;
        sink_(file_ + ":" + std::to_string(row) + ": " + kind + ": " + text + (n == kSaid ? " (more of this kind are only counted)" : ""));
    }
    /// Reports a text that names its place itself.
    void say(const std::string& text) const {
        if (sink_) sink_(text);
    }
    [[nodiscard]] const std::map<std::string, std::uint64_t>& counts() const { return counts_; }

  private:
    std::string file_;
    Sink sink_;
    std::map<std::string, std::uint64_t> counts_;
};

struct ImportSettings {
    std::filesystem::path file;
    ImportMap map;
    std::filesystem::path out;
    ImportedRig rig;
    record::Specimen specimen{};  ///< of every maneuver in it
    std::string config_hash;
    /// Called occasionally with the share of the reading that is done, 0 to 1.
    std::function<void(double)> progress{};
};

struct ImportedManeuver {
    std::filesystem::path folder;
    std::string outcome;  ///< "finished", "released" before standstill, or "recording_broken" (gap, time reset, end of file)
    std::uint64_t first_row = 0;
    record::Figures figures;
};

struct ImportReport {
    std::uint64_t rows = 0;
    std::string log_troubles;  ///< of a log of frames, by kind; empty: none
    std::vector<ImportedManeuver> maneuvers;
};

/// Throws std::invalid_argument for an invalid text of the specimen (check_texts()), std::runtime_error if the file cannot be read, a unit is
/// impossible (naming column, values and likely unit), or `out` already holds maneuvers.
[[nodiscard]] ImportReport import_recording(const ImportSettings& settings, ImportNotes& notes);

}  // namespace rig::replay
