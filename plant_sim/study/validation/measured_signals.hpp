/// What the sensors said, sample by sample, from the frames of a log: decoded and checked as the controller does it.
#pragma once

#include <cstdint>
#include <deque>

#include "firmware/can/controller_port.hpp"
#include "rig_bridge/replay/log_reader.hpp"

namespace rig {

/// With SYNC in the log a sample is what was known at a SYNC, and its time the SYNC's number times the period. Without, a
/// sample ends with each pressure frame, and its time is that frame's stamp. Times start at 0 with the first sample.
class MeasuredSignals {
  public:
    /// All must outlive the object; `log` must have been opened with `layout`. `period` > 0: of the rig that sent SYNC.
    MeasuredSignals(LogReader& log, const antiskid::can::Layout& layout, Time period);

    /// The next sample; false at the end, and when SYNC numbers start again: another recording begins there.
    [[nodiscard]] bool next();

    [[nodiscard]] double time_s() const { return static_cast<double>((time_ - first_).count()) * 1e-9; }
    [[nodiscard]] const antiskid::control::Sensors& sensors() const { return port_.sensors(); }
    [[nodiscard]] std::uint64_t line() const { return line_; }
    [[nodiscard]] bool lockstep() const { return lockstep_; }
    [[nodiscard]] bool restarted() const { return restarted_; }
    /// Of the four inputs, that failed a check.
    [[nodiscard]] std::uint64_t rejected() const;

  private:
    static constexpr std::size_t kAhead = 512;  // frames looked at to find out whether there is SYNC

    [[nodiscard]] bool read(LogFrame& out);
    [[nodiscard]] bool sync(Time stamp);

    LogReader& log_;
    const antiskid::can::Layout& layout_;
    Time period_;
    antiskid::can::ControllerPort port_;
    std::deque<LogFrame> ahead_;
    bool lockstep_ = false;
    bool started_ = false;
    bool restarted_ = false;
    std::uint64_t number_ = 0;
    std::uint64_t line_ = 0;
    Time first_{};
    Time time_{};
};

}  // namespace rig
