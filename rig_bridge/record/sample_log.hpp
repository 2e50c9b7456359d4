/// modbus.csv: the PLC's measured values, one row per reading.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "firmware/can/frame.hpp"
#include "rig_bridge/record/line_file.hpp"
#include "rig_bridge/rig/quantities.hpp"

namespace rig::record {

/// Columns: time_s (wall clock since 1970, microseconds, as in bus.log), then every Measured quantity by name with its unit. The first
/// row names them.
class SampleLog {
  public:
    explicit SampleLog(std::unique_ptr<LineFile> file);

    void write(antiskid::can::Time wall_clock, const MeasuredValues& values);
    void flush() { file_->flush(); }
    bool finish() { return file_->finish(); }

    [[nodiscard]] std::uint64_t rows() const { return file_->lines() - 1; }
    [[nodiscard]] std::uint64_t missing() const { return file_->missing(); }
    [[nodiscard]] std::string error() const { return file_->error(); }

  private:
    std::unique_ptr<LineFile> file_;
};

/// The column of a quantity: "flywheel_speed_mps".
[[nodiscard]] std::string sample_column(Measured quantity);

}  // namespace rig::record
