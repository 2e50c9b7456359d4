/// Frames of a bus log, one after the other, in constant memory: as `candump -l` writes it, or as Vector (ASC, BLF) and PEAK (TRC) do, told by its
/// first bytes.
///
///     LogReader log("bus.log", {}, warnings);
///     for (LogFrame f; log.next(f);) use(f);
///
/// Whatever a log may hold ends in a frame or in a named warning with its line, never in silence. Several million frames a
/// second of candump; two to three hundred thousand of the others, whose lines are those of foreign_log.py.
#pragma once

#include <bitset>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "firmware/can/candump.hpp"
#include "firmware/can/frame.hpp"
#include "firmware/can/layout.hpp"
#include "rig_bridge/replay/foreign_log.hpp"
#include "rig_bridge/replay/line_source.hpp"
#include "rig_bridge/replay/log_warnings.hpp"

namespace rig::replay {

using antiskid::can::Frame;
using antiskid::can::Time;

struct LogFrame {
    std::uint64_t line = 0;
    Frame frame;  ///< `received` is the time in the log
    bool extended = false;
    bool remote = false;
    bool error = false;
};

struct LogOptions {
    /// Lines of this interface only; none: of the first one in the log.
    std::optional<std::string> interface;
    /// With a layout: only data frames with an 11-bit identifier that it has are given, everything else is a warning.
    /// Without: every classic frame, error frames included. Must outlive the reader.
    const antiskid::can::Layout* layout = nullptr;
};

class LogReader {
  public:
    /// Throws std::runtime_error naming the file when it cannot be opened, or is an MDF recording. `warnings` must outlive the reader.
    LogReader(const std::filesystem::path& file, const LogOptions& options, LogWarnings& warnings);

    /// The next frame; false at the end. Throws std::runtime_error naming the file and what mends it where python3-can is missing.
    [[nodiscard]] bool next(LogFrame& out);

    [[nodiscard]] std::uint64_t lines() const { return source_.lines(); }
    [[nodiscard]] std::uint64_t frames() const { return frames_; }
    /// Share of the file that was read, 0 to 1.
    [[nodiscard]] double share() const { return foreign_ ? foreign_->share() : source_.share(); }
    /// The one that is read; empty before the first line.
    [[nodiscard]] const std::string& interface() const { return interface_; }

  private:
    /// False when the line is not to be used; the warning has then been made.
    bool take(const LineSource::Line& line, LogFrame& out);
    void reject(const LineSource::Line& line, const antiskid::can::CandumpFailure& failure);
    bool is_ours(const LineSource::Line& line, std::string_view interface);
    void say_end();
    /// Warns of a frame that no layout has; whether it is to be given all the same.
    bool unusual(const LogFrame& frame);

    std::unique_ptr<ForeignLog> foreign_;  // none: candump
    LineSource source_;
    LogWarnings& warnings_;
    std::string interface_;
    bool with_layout_;
    std::bitset<2048> known_;
    std::bitset<2048> said_;  // foreign identifiers
    Time newest_{};
    std::uint64_t frames_ = 0;
    bool end_said_ = false;
};

}  // namespace rig::replay
