/// The stops of a sweep that is under way: a table that grows by whole lines, and from which the same sweep goes on.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "firmware/host/settings/file_descriptor.hpp"
#include "plant_sim/study/sweep/stops_table.hpp"

namespace sweep {

class PartFile {
  public:
    /// Makes the file, or takes up what an earlier run left of the same sweep. Throws settings::Error where it is of another
    /// one or damaged, std::runtime_error where it cannot be made or another process is at work on it.
    PartFile(std::filesystem::path path, const SweepPlan& plan);

    /// What was there before.
    [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
    /// Whole lines, with their ends. They survive the death of this program. Throws std::runtime_error where they cannot be written.
    void append(std::string_view lines);
    void remove();

  private:
    std::filesystem::path path_;
    settings::FileDescriptor file_;
    std::vector<Row> rows_;
};

}  // namespace sweep
