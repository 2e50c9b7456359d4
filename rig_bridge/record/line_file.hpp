/// A file that grows line by line, whoever writes it: AppendFile at once, LiveFile on a thread of its own.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rig::record {

class LineFile {
  public:
    LineFile() = default;
    virtual ~LineFile() = default;
    LineFile(const LineFile&) = delete;
    LineFile& operator=(const LineFile&) = delete;

    /// One line without its end, at most 4096 characters. Does not allocate.
    virtual void line(std::string_view text) = 0;
    /// Hands everything to the kernel: from here on it survives the death of this program.
    virtual void flush() = 0;
    /// Everything is on the disk, the file closed: no line may follow. False when lines are missing, see error().
    virtual bool finish() = 0;

    [[nodiscard]] virtual std::uint64_t lines() const = 0;    ///< taken, those missing included
    [[nodiscard]] virtual std::uint64_t missing() const = 0;  ///< could not be written
    /// "PATH: No space left on device; 12 lines are missing"; empty while all is well.
    [[nodiscard]] virtual std::string error() const = 0;
};

}  // namespace rig::record
