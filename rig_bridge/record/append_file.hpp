/// A file that grows line by line: buffered, told to the disk when asked, and never the death of its writer. When the disk is full,
/// what was written stays, up to its last whole line; the rest is counted.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/host/settings/storage.hpp"
#include "rig_bridge/record/line_file.hpp"

namespace rig::record {

class AppendFile final : public LineFile {
  public:
    /// Makes a new file; missing parent directories are created. That it is there survives a power cut. Throws std::runtime_error naming
    /// `path` when it is there already or cannot be made.
    explicit AppendFile(const std::filesystem::path& path, const settings::Storage& storage = settings::PosixStorage{});
    /// As finish().
    ~AppendFile() override;

    /// Calls the kernel once the buffer is full.
    void line(std::string_view text) override;
    void flush() override;
    /// As flush(), then told to the disk: what was written survives a power cut.
    void sync();
    bool finish() override;

    [[nodiscard]] std::uint64_t lines() const override { return lines_; }
    [[nodiscard]] std::uint64_t missing() const override { return missing_; }
    [[nodiscard]] std::string error() const override;

  private:
    void fail(int error);

    std::filesystem::path path_;
    std::unique_ptr<settings::File> file_;  // none: finished
    std::vector<char> buffer_;
    std::uint64_t lines_ = 0;
    std::uint64_t lines_in_buffer_ = 0;
    std::uint64_t missing_ = 0;
    std::int64_t size_ = 0;  // bytes in the file, whole lines
    int error_ = 0;
};

}  // namespace rig::record
