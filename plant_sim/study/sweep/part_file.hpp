/// Finished stops of an unfinished sweep: a table that grows by complete lines, and from which the same sweep can continue.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "firmware/host/settings/file_descriptor.hpp"
#include "plant_sim/study/sweep/stops_table.hpp"

namespace sweep {

class PartFile {
  public:
    /// Creates the file, or reads the rows that an earlier run of the same sweep left. Throws settings::Error if the file is of another sweep or
    /// damaged, std::runtime_error if it cannot be created or another process uses it.
    PartFile(std::filesystem::path path, const SweepPlan& plan);

    /// The rows of the earlier run.
    [[nodiscard]] const std::vector<SweptStop>& rows() const { return rows_; }
    /// Appends complete lines, with their ends. They survive the end of this program. Throws std::runtime_error if they cannot be written.
    void append(std::string_view lines);

  private:
    std::filesystem::path path_;
    settings::FileDescriptor file_;
    std::vector<SweptStop> rows_;
};

}  // namespace sweep
