/// The figures of a maneuver from the frames on the bus alone: live from the recorder, or again from its bus.log, with the
/// same bits.
///
///     BusMeter meter(layout, parameters);
///     for (frames) if (frame.plain()) meter.accept(frame.frame);       // CapturedFrame, or a line of a log
///     Figures figures = meter.figures();
///
/// Time: where SYNC frames are on the bus, SYNC number times control period; a sample is what was known when a SYNC ended it; a number
/// that was overtaken, or that the next does not go on from, counts as no time. Without SYNC frames the kernel's stamp, cut to
/// microseconds as a log has it; a sample ends with each pressure frame, the last of the sensors'. A stamp that goes back (the wall
/// clock was set) counts as no time. Phases come from the maneuver state: a change counts from the next sample on.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/can/observer.hpp"
#include "rig_bridge/record/meter.hpp"

namespace rig {

class BusMeter {
  public:
    /// `layout` must outlive the meter.
    BusMeter(const antiskid::can::Layout& layout, const MeterParameters& parameters);
    BusMeter(const antiskid::can::Layout&& layout, const MeterParameters& parameters) = delete;

    /// Plain data frames with an 11-bit identifier, in the order in which they were recorded; `received` is the stamp of
    /// the record.
    void accept(const antiskid::can::Frame& frame);

    [[nodiscard]] Figures figures() const { return meter_.figures(); }
    [[nodiscard]] std::vector<std::string> warnings() const { return meter_.warnings(); }
    [[nodiscard]] const Meter& meter() const { return meter_; }
    [[nodiscard]] const antiskid::can::BusView& view() const { return observer_.view(); }
    [[nodiscard]] const antiskid::can::Observer& observer() const { return observer_; }
    /// Every fault that the controller named since the end of spin-up, where it is armed.
    [[nodiscard]] antiskid::control::FaultSet faults() const { return faults_; }
    /// Frames missing as their counters say, of all messages: on the bus, or between bus and recorder.
    [[nodiscard]] std::uint64_t frames_lost() const;
    /// Times that a stamp was older than the one before.
    [[nodiscard]] std::uint64_t steps_back() const { return steps_back_; }

  private:
    void count_sync();
    void sample(double time_s);

    const antiskid::can::Layout& layout_;
    double period_s_;
    antiskid::can::Observer observer_;
    Meter meter_;
    antiskid::control::FaultSet faults_;
    bool wheel_reported_ = false, flywheel_reported_ = false,
         load_cells_reported_ = false;  // since the newest sample
    bool sync_ = false;
    std::uint32_t last_sync_ = 0;
    std::optional<std::uint32_t> leapt_to_;  // by the newest number
    std::uint64_t syncs_ = 0;
    bool stamped_ = false;
    std::int64_t first_us_ = 0;
    std::int64_t newest_us_ = 0;
    std::uint64_t steps_back_ = 0;
};

}  // namespace rig
