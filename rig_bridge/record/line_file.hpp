/// Interface to a file written line by line: AppendFile writes on the calling thread, LiveFile on its own.
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
    /// Passes everything to the kernel, so that it survives the end of this program.
    virtual void flush() = 0;
    /// Stores everything on the disk and closes the file; no line may follow. False if lines are missing, see error().
    virtual bool finish() = 0;

    [[nodiscard]] virtual std::uint64_t lines() const = 0;    ///< lines taken, including missing ones
    [[nodiscard]] virtual std::uint64_t missing() const = 0;  ///< lines that could not be written
    /// "PATH: No space left on device; 12 lines are missing"; empty while all is well.
    [[nodiscard]] virtual std::string error() const = 0;
};

}  // namespace rig::record
