/// Writes tables of any length in constant memory; the file appears only when complete.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace rig::replay {

/// A file that gets its final name by commit(); before that, and after a failure, an existing file of that name is unchanged.
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
    /// Writes one number per column. row() and finish() throw std::runtime_error naming the file if it cannot be written.
    virtual void row(const std::vector<double>& values) = 0;
    virtual void finish() = 0;
};

/// One row of names, commas, decimal points; readable by PlotJuggler, pandas and spreadsheets.
[[nodiscard]] std::unique_ptr<TableWriter> csv_writer(const std::filesystem::path& path, const std::vector<std::string>& columns);
/// MATLAB v7.3: a column vector of each name.
[[nodiscard]] std::unique_ptr<TableWriter> mat_writer(const std::filesystem::path& path, const std::vector<std::string>& columns);

}  // namespace rig::replay
