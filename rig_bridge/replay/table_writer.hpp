/// Tables of any length on the disk, in constant memory: whole or not there.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace rig::replay {

/// A file that has its name once commit() was called; until then, and after a failure, there is none of that name but what was there before.
class PartFile {
  public:
    explicit PartFile(const std::filesystem::path& path);
    ~PartFile();
    PartFile(const PartFile&) = delete;
    PartFile& operator=(const PartFile&) = delete;

    [[nodiscard]] const std::string& name() const { return name_; }
    /// Where to write.
    [[nodiscard]] const std::string& part() const { return part_; }
    /// Throws std::filesystem::filesystem_error.
    void commit();

  private:
    std::string name_, part_;
};

class TableWriter {
  public:
    virtual ~TableWriter() = default;
    /// One number for each column. Throws std::runtime_error naming the file where it cannot be written, as finish() does.
    virtual void row(const std::vector<double>& values) = 0;
    virtual void finish() = 0;
};

/// One row of names, commas, decimal points; what PlotJuggler, pandas and spreadsheets read.
[[nodiscard]] std::unique_ptr<TableWriter> csv_writer(const std::filesystem::path& path, const std::vector<std::string>& columns);
/// MATLAB v7.3: a column vector of each name.
[[nodiscard]] std::unique_ptr<TableWriter> mat_writer(const std::filesystem::path& path, const std::vector<std::string>& columns);

}  // namespace rig::replay
