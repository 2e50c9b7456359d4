/// bus.log: every recorded frame, as `candump -l` writes it, readable by can-utils, python-can and rig-replay.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "rig_bridge/record/captured_frame.hpp"
#include "rig_bridge/record/line_file.hpp"

namespace rig::record {

class BusLog {
  public:
    /// `interface`: the name written in every line.
    BusLog(std::unique_ptr<LineFile> file, std::string interface);
    /// Writes to a new AppendFile at `path`.
    BusLog(const std::filesystem::path& path, std::string interface);

    /// Does not allocate. Flushes if the frame's stamp is a second later than at the last flush.
    void write(const CapturedFrame& frame);
    /// Passes buffered lines to the kernel; call it while the bus is quiet.
    void flush() { file_->flush(); }
    /// Stores everything on the disk and closes the file. False if frames are missing.
    bool finish();

    [[nodiscard]] std::uint64_t frames() const { return file_->lines() + unwritable_; }
    /// Frames that could not be written: the disk is full or too slow, or their time stamp is none that a log can have.
    [[nodiscard]] std::uint64_t missing() const { return file_->missing() + unwritable_; }
    /// Names file and reason, and how many frames are missing; empty while all is well.
    [[nodiscard]] std::string error() const;

  private:
    std::unique_ptr<LineFile> file_;
    std::string interface_;
    antiskid::can::Time flushed_{};
    std::uint64_t unwritable_ = 0;
};

}  // namespace rig::record
