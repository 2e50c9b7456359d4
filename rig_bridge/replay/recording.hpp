/// Reads a recording of another system (table or log of frames) row by row: only the wanted columns, in their own units.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "rig_bridge/record/meter.hpp"
#include "rig_bridge/replay/import_map.hpp"
#include "rig_bridge/replay/log_warnings.hpp"

namespace rig::replay {

struct RecordedRow {
    std::uint64_t row = 0;                ///< of the file, from 1 (of the variables in a .mat, the frames in a log)
    std::vector<double> values;           ///< in the order of the wanted columns; NaN where there is no number
    std::vector<std::string> unreadable;  ///< "column 3 (p_Bremse): 'xx'" for each cell that holds no number
};

class Recording {
  public:
    virtual ~Recording() = default;
    [[nodiscard]] virtual bool next(RecordedRow& row) = 0;
    /// The unit that the file itself states for a wanted column; empty: none.
    [[nodiscard]] virtual std::string stated_unit(std::size_t wanted) const = 0;
    /// Share of the file that was read, 0 to 1.
    [[nodiscard]] virtual double share() const = 0;
    /// What was wrong with the frames so far, by kind: "foreign_id 4000"; empty: nothing.
    [[nodiscard]] virtual std::string troubles() const { return {}; }
};

/// Throws std::runtime_error naming the file if it is unreadable or lacks a column; the text then lists the columns there are. CSV and logs of frames
/// are streamed; the variables of a .mat are read whole.
[[nodiscard]] std::unique_ptr<Recording> open_recording(const std::filesystem::path& file, const ImportMap& map,
                                                        const std::vector<std::string>& wanted);
[[nodiscard]] std::unique_ptr<Recording> open_mat(const std::filesystem::path& file, const std::vector<std::string>& wanted);
/// Opens a log in the map's layout, with its channels in their order. `map` must outlive it; `warnings` receives problems of single frames.
[[nodiscard]] std::unique_ptr<Recording> open_bus(const std::filesystem::path& file, const ImportMap& map, const record::MeterParameters& rig,
                                                  LogWarnings::Sink warnings);

}  // namespace rig::replay
