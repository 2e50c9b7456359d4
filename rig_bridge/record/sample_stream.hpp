/// Samples out of the frames on the bus, each with its time: live, or again from a log, with the same bits.
///
///     SampleStream samples(layout, period_s);
///     for (frames) if (samples.accept(frame) && samples.ended()) use(samples.view(), samples.time_s());
///
/// Where SYNC frames are on the bus, time is SYNC number times control period, and a sample is what was known when a SYNC ended it; a number
/// that was overtaken, or that the next does not go on from, counts as no time. Without SYNC frames it is the kernel's stamp, cut to
/// microseconds as a log has it; a sample ends with each pressure frame, the last of the sensors'. A stamp that goes back (the wall
/// clock was set) counts as no time. Before all three sensors were heard there is no sample.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/can/observer.hpp"

namespace rig::record {

class SampleStream {
  public:
    /// `layout` must outlive the stream.
    SampleStream(const antiskid::can::Layout& layout, double period_s) : layout_(layout), period_s_(period_s), observer_(layout) {}
    SampleStream(const antiskid::can::Layout&& layout, double period_s) = delete;

    /// There will be SYNC: no sample ends before the first.
    void expect_sync() { sync_expected_ = true; }
    /// Plain data frames with an 11-bit identifier, in the order in which they were recorded; `received` is the stamp of the record. The role
    /// of one that passed every check.
    std::optional<antiskid::can::Role> accept(const antiskid::can::Frame& frame);

    /// Whether the newest frame ended a sample.
    [[nodiscard]] bool ended() const { return ended_; }
    [[nodiscard]] double time_s() const { return time_s_; }
    /// The same in whole nanoseconds: times of samples can be subtracted without rounding.
    [[nodiscard]] antiskid::can::Time time() const { return time_; }
    [[nodiscard]] const antiskid::can::BusView& view() const { return observer_.view(); }
    [[nodiscard]] const antiskid::can::Observer& observer() const { return observer_; }
    /// Times that SYNC numbers began anew.
    [[nodiscard]] std::uint64_t restarts() const { return restarts_; }
    /// Times that a stamp was older than the one before.
    [[nodiscard]] std::uint64_t steps_back() const { return steps_back_; }

  private:
    /// False for a number that counts as no time.
    [[nodiscard]] bool count_sync();
    void count_stamp(antiskid::can::Time stamp);

    const antiskid::can::Layout& layout_;
    double period_s_;
    antiskid::can::Observer observer_;
    bool ended_ = false;
    double time_s_ = 0.0;
    antiskid::can::Time time_{};
    bool sync_expected_ = false, sync_ = false;
    std::uint32_t last_sync_ = 0;
    std::optional<std::uint32_t> leapt_to_;  // by the newest number
    std::uint64_t syncs_ = 0, restarts_ = 0;
    bool stamped_ = false;
    std::int64_t first_us_ = 0, newest_us_ = 0;
    std::uint64_t steps_back_ = 0;
};

}  // namespace rig::record
