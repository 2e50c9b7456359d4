/// Makes samples with their time from the frames on the bus: live, or later from a log, with bit-identical results.
///
///     SampleStream samples(layout, period_s);
///     for (frames) if (samples.accept(frame) && samples.ended()) use(samples.view(), samples.time_s());
///
/// With SYNC frames, time is SYNC number times control period, and each SYNC ends a sample; a number that is out of order, or that the next one does
/// not continue, does not advance time. Without SYNC, time is the kernel's stamp, truncated to microseconds as in a log, and each pressure frame, the
/// last of the sensors', ends a sample; a stamp that goes back (wall clock set) does not advance time. There is no sample before all three sensors
/// have sent.
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

    /// SYNC frames will come: no sample ends before the first one.
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
    /// Number of restarts of the SYNC count.
    [[nodiscard]] std::uint64_t restarts() const { return restarts_; }
    /// Number of stamps older than the previous one.
    [[nodiscard]] std::uint64_t steps_back() const { return steps_back_; }

  private:
    /// False for a number that does not advance time.
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
