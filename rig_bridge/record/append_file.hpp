/// A buffered file written line by line and synced on request. Write errors do not throw: when the disk is full, the file keeps its whole lines so
/// far, and the missing ones are counted.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "firmware/host/settings/storage.hpp"
#include "rig_bridge/record/line_file.hpp"

namespace rig::record {

class AppendFile final : public LineFile {
  public:
    /// Creates the file and missing parent directories, durably. Throws std::runtime_error naming `path` if it exists or cannot be created.
    explicit AppendFile(const std::filesystem::path& path, const settings::Storage& storage = settings::PosixStorage{});
    /// As finish().
    ~AppendFile() override;

    /// Buffers the line; writes when the buffer is full.
    void line(std::string_view text) override;
    void flush() override;
    /// flush() and fsync: what was written survives a power cut.
    void sync();
    bool finish() override;

    [[nodiscard]] std::uint64_t lines() const override { return lines_; }
    [[nodiscard]] std::uint64_t missing() const override { return missing_; }
    [[nodiscard]] std::string error() const override;

  private:
    void fail(int error);

    std::filesystem::path path_;
    std::unique_ptr<settings::File> file_;  // none: finished
    std::string buffer_;
    std::uint64_t lines_ = 0;
    std::uint64_t lines_in_buffer_ = 0;
    std::uint64_t missing_ = 0;
    std::int64_t size_ = 0;  // bytes in the file, whole lines
    int error_ = 0;
};

}  // namespace rig::record
