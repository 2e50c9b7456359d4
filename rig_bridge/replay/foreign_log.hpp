/// Reads logs in other formats than candump's. A child process runs foreign_log.py, with the readers of python3-can (recommended by the Debian
/// package), and delivers the frames as candump lines.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>

#include "firmware/host/settings/file_descriptor.hpp"

namespace rig::replay {

enum class LogFormat : std::uint8_t {
    candump,
    vector_asc,
    vector_blf,
    peak_trc,
    mdf,  ///< not read here
};

/// Determined by the file's first bytes, plain or gzip; candump if no other format matches.
[[nodiscard]] LogFormat log_format(const std::filesystem::path& file);

/// Throws std::runtime_error for an MDF recording, with the command that converts it.
void reject_mdf(const std::filesystem::path& file);

class ForeignLog {
  public:
    /// Starts the process. Throws std::runtime_error naming the file and the remedy.
    ForeignLog(const std::filesystem::path& file, LogFormat format);
    /// Ends the process.
    ~ForeignLog();
    ForeignLog(const ForeignLog&) = delete;
    ForeignLog& operator=(const ForeignLog&) = delete;

    /// The end of a pipe, with lines of candump.
    [[nodiscard]] int lines() const { return lines_.get(); }
    /// Share of the file that was read, 0 to 1.
    [[nodiscard]] double share() const;

    struct End {
        bool damaged = false;  ///< the log is truncated or damaged; the lines before that were delivered
        std::string text;      ///< the damage; otherwise what was left out, if anything
    };
    /// Call after the last line. Throws std::runtime_error naming the file and the remedy if the log cannot be read.
    [[nodiscard]] End finish();

  private:
    std::string name_;
    settings::FileDescriptor file_;
    settings::FileDescriptor lines_{-1}, said_{-1};
    double size_ = 0.0;
    pid_t process_ = -1;
};

}  // namespace rig::replay
