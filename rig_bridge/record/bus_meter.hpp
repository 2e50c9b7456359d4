/// The figures of a maneuver from the frames on the bus alone: live from the recorder, or again from its bus.log, with the
/// same bits.
///
///     BusMeter meter(layout, parameters);
///     for (frames) if (frame.plain()) meter.accept(frame.frame);       // CapturedFrame, or a line of a log
///     Figures figures = meter.figures();
///
/// Samples and their time: see sample_stream.hpp. Phases come from the maneuver state: a change counts from the next sample on.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rig_bridge/record/meter.hpp"
#include "rig_bridge/record/sample_stream.hpp"

namespace rig::record {

/// The end of a warning that bounds what the brake took beyond the figures.
[[nodiscard]] std::string in_no_record(double max_J);

class BusMeter {
  public:
    /// `layout` must outlive the meter.
    BusMeter(const antiskid::can::Layout& layout, const MeterParameters& parameters);
    BusMeter(const antiskid::can::Layout&& layout, const MeterParameters& parameters) = delete;

    /// Plain data frames with an 11-bit identifier, in the order in which they were recorded; `received` is the stamp of
    /// the record.
    void accept(const antiskid::can::Frame& frame);

    [[nodiscard]] Figures figures() const { return meter_.figures(); }
    /// Those of the meter, and of a record that has come to its end with a brake that nobody saw released: "ends_unheard: at 9.5 m/s, and the brake
    /// may have taken up to 0.11 MJ that are in no record".
    [[nodiscard]] std::vector<std::string> warnings() const;
    /// The brake has come on, and nobody saw it released.
    [[nodiscard]] bool open() const { return meter_.open() || (braked_ && !meter_.started()); }
    [[nodiscard]] const Meter& meter() const { return meter_; }
    [[nodiscard]] const antiskid::can::BusView& view() const { return samples_.view(); }
    [[nodiscard]] const antiskid::can::Observer& observer() const { return samples_.observer(); }
    /// Every fault that the controller named since the end of spin-up, where it is armed.
    [[nodiscard]] antiskid::control::FaultSet faults() const { return faults_; }
    /// Frames missing as their counters say, of all messages: on the bus, or between bus and recorder.
    [[nodiscard]] std::uint64_t frames_lost() const;
    /// Times that a stamp was older than the one before.
    [[nodiscard]] std::uint64_t steps_back() const { return samples_.steps_back(); }

  private:
    const antiskid::can::Layout& layout_;
    SampleStream samples_;
    Meter meter_;
    antiskid::control::FaultSet faults_;
    bool wheel_reported_ = false, flywheel_reported_ = false, load_cells_reported_ = false, braked_ = false;  // since the newest sample
};

}  // namespace rig::record
