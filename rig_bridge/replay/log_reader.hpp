/// Reads the frames of a bus log in constant memory: of `candump -l`, Vector (ASC, BLF) or PEAK (TRC), detected by its first bytes.
///
///     LogReader log("bus.log", {}, warnings);
///     for (LogFrame f; log.next(f);) use(f);
///
/// Every line gives a frame or a named warning with its line number; none is skipped silently. For formats other than candump's, line numbers are
/// those of foreign_log.py's output.
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
    /// Only lines of this interface; none: the first interface in the log.
    std::optional<std::string> interface;
    /// With a layout: returns only data frames with its 11-bit identifiers, anything else is a warning. Without: returns every classic frame,
    /// including error frames. Must outlive the reader.
    const antiskid::can::Layout* layout = nullptr;
};

class LogReader {
  public:
    /// Throws std::runtime_error naming the file if it cannot be opened or is an MDF recording. `warnings` must outlive the reader.
    LogReader(const std::filesystem::path& file, const LogOptions& options, LogWarnings& warnings);
    /// Reads a log of candump's format in memory, which must outlive the reader.
    LogReader(LogText text, const LogOptions& options, LogWarnings& warnings);

    /// The next frame; false at the end. Throws std::runtime_error naming the file and the remedy if python3-can is missing.
    [[nodiscard]] bool next(LogFrame& out);

    [[nodiscard]] std::uint64_t lines() const { return source_.lines(); }
    [[nodiscard]] std::uint64_t frames() const { return frames_; }
    /// Share of the file that was read, 0 to 1.
    [[nodiscard]] double share() const { return foreign_ ? foreign_->share() : source_.share(); }
    /// The interface that is read; empty before the first line.
    [[nodiscard]] const std::string& interface() const { return interface_; }

  private:
    /// False if the line is not used; a warning has then been added.
    bool take(const LineSource::Line& line, LogFrame& out);
    void reject(const LineSource::Line& line, const antiskid::can::CandumpFailure& failure);
    bool is_ours(const LineSource::Line& line, std::string_view interface);
    void say_end();
    /// Warns of a frame that is not in the layout; returns whether it is returned nevertheless.
    bool unusual(const LogFrame& frame);

    std::unique_ptr<ForeignLog> foreign_;  // none: candump
    LineSource source_;
    LogWarnings& warnings_;
    std::string interface_;
    bool with_layout_ = false;
    std::bitset<2048> known_;
    std::bitset<2048> said_;  // foreign identifiers
    Time newest_{};
    std::uint64_t frames_ = 0;
    bool end_said_ = false;
};

}  // namespace rig::replay
