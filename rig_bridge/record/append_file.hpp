/// A file that grows line by line: buffered, told to the disk now and then, and never the death of its writer. When the disk is full,
/// what was written stays, up to its last whole line; the rest is counted.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "config/reader/file_descriptor.hpp"

namespace rig {

class AppendFile {
  public:
    /// Makes a new file; missing parent directories are created. Throws std::runtime_error naming `path` when it is there
    /// already or cannot be made.
    explicit AppendFile(const std::filesystem::path& path);
    /// As finish().
    ~AppendFile();
    AppendFile(const AppendFile&) = delete;
    AppendFile& operator=(const AppendFile&) = delete;

    /// One line without its end, at most 4096 characters. Does not allocate; calls the kernel once the buffer is full.
    void line(std::string_view text);
    /// Hands everything to the kernel: from here on it survives the death of this program.
    void flush();
    /// As flush(), then fsync: survives a power cut. No line may follow. False when lines are missing, see error().
    bool finish();

    [[nodiscard]] std::uint64_t lines() const { return lines_; }      ///< taken, those missing included
    [[nodiscard]] std::uint64_t missing() const { return missing_; }  ///< could not be written
    /// "PATH: No space left on device; 12 lines are missing"; empty while all is well.
    [[nodiscard]] std::string error() const;

  private:
    void fail(int error);

    std::filesystem::path path_;
    settings::FileDescriptor file_;
    std::vector<char> buffer_;
    std::uint64_t lines_ = 0;
    std::uint64_t lines_in_buffer_ = 0;
    std::uint64_t missing_ = 0;
    std::int64_t size_ = 0;  // bytes in the file, whole lines
    int error_ = 0;
};

}  // namespace rig
