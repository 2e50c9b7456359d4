/// Computes the figures of a maneuver from the frames on the bus alone: live, or later from bus.log, with bit-identical results.
///
///     BusMeter meter(layout, parameters);
///     for (frames) if (frame.plain()) meter.accept(frame.frame);       // CapturedFrame, or a line of a log
///     Figures figures = meter.figures();
///
/// Samples and their time: see sample_stream.hpp. Phases come from the maneuver state; a change takes effect at the next sample.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rig_bridge/record/meter.hpp"
#include "rig_bridge/record/sample_stream.hpp"

namespace rig::record {

class BusMeter {
  public:
    /// `layout` must outlive the meter.
    BusMeter(const antiskid::can::Layout& layout, const MeterParameters& parameters);
    BusMeter(const antiskid::can::Layout&& layout, const MeterParameters& parameters) = delete;

    /// Plain data frames with an 11-bit identifier, in the order in which they were recorded; `received` is the stamp of
    /// the record.
    void accept(const antiskid::can::Frame& frame);

    [[nodiscard]] Figures figures() const { return meter_.figures(); }
    /// Warnings of the meter, and if the record ends without the brake's release: "ends_unheard: at 9.5 m/s, and the brake may have taken up to 0.11
    /// MJ that are in no record".
    [[nodiscard]] std::vector<std::string> warnings() const;
    /// Whether the brake has come on without a recorded release.
    [[nodiscard]] bool open() const { return meter_.open() || (braked_ && !meter_.started()); }
    [[nodiscard]] const Meter& meter() const { return meter_; }
    [[nodiscard]] const antiskid::can::BusView& view() const { return samples_.view(); }
    [[nodiscard]] const antiskid::can::Observer& observer() const { return samples_.observer(); }
    /// Every fault reported by the controller since the end of spin-up, where it is armed.
    [[nodiscard]] antiskid::control::FaultSet faults() const { return faults_; }
    /// Missing frames of all messages by their alive counters, lost on the bus or before the recorder.
    [[nodiscard]] std::uint64_t frames_lost() const;
    /// Number of stamps older than the previous one.
    [[nodiscard]] std::uint64_t steps_back() const { return samples_.steps_back(); }

  private:
    const antiskid::can::Layout& layout_;
    SampleStream samples_;
    Meter meter_;
    antiskid::control::FaultSet faults_;
    bool wheel_reported_ = false, flywheel_reported_ = false, load_cells_reported_ = false, braked_ = false;  // since the newest sample
};

}  // namespace rig::record
