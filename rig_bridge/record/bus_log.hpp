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
    bool finish() { return file_->finish(); }

    [[nodiscard]] std::uint64_t frames() const { return file_->lines(); }
    /// Frames that could not be written: the disk is full, or too slow.
    [[nodiscard]] std::uint64_t missing() const { return file_->missing(); }
    /// Names file and reason, and how many frames are missing; empty while all is well.
    [[nodiscard]] std::string error() const { return file_->error(); }

  private:
    std::unique_ptr<LineFile> file_;
    std::string interface_;
    antiskid::can::Time flushed_{};
};

}  // namespace rig::record
