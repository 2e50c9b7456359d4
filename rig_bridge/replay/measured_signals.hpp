/// Reads the signals of a log sample by sample.
#pragma once

#include <cstdint>
#include <deque>

#include "rig_bridge/record/sample_stream.hpp"
#include "rig_bridge/replay/log_reader.hpp"

namespace rig::replay {

/// Samples and their time: see sample_stream.hpp. Times start at 0 with the first sample and increase.
class MeasuredSignals {
  public:
    /// All must outlive the object; `log` must have been opened with `layout`. `period_s` > 0: of the rig that sent SYNC.
    MeasuredSignals(LogReader& log, const antiskid::can::Layout& layout, double period_s);

    /// The next sample; false at the end, and if SYNC numbers restart, which begins another recording.
    [[nodiscard]] bool next();

    [[nodiscard]] double time_s() const { return static_cast<double>((newest_ - first_).count()) * 1e-9; }
    [[nodiscard]] const antiskid::can::BusView& view() const { return samples_.view(); }
    [[nodiscard]] std::uint64_t line() const { return line_; }
    [[nodiscard]] bool lockstep() const { return lockstep_; }
    [[nodiscard]] bool restarted() const { return samples_.restarts() > 0; }
    /// Number of frames of the controller's four inputs that failed a check.
    [[nodiscard]] std::uint64_t rejected() const;

  private:
    [[nodiscard]] bool read(LogFrame& out);

    LogReader& log_;
    record::SampleStream samples_;
    std::deque<LogFrame> ahead_;
    bool lockstep_ = false;
    bool started_ = false;
    std::uint64_t line_ = 0;
    antiskid::can::Time first_{}, newest_{};
};

}  // namespace rig::replay
