/// What makes the loop go round: the sensors' frame, the machine's timer, or SYNC. Waits for the next period and
/// takes in the frames that belong to it.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>

#include "firmware/host/clock.hpp"
#include "firmware/host/frame_intake.hpp"
#include "firmware/host/periodic_timer.hpp"

namespace antiskid::host {

struct Wake {
    Time now{};                 ///< for the controller
    Time woke{};                ///< on the machine's clock; in lockstep the reception of SYNC
    Time latency{};             ///< from what should have woken the loop to `woke`
    std::uint64_t skipped = 0;  ///< periods missed since the last wake-up
    bool synchronised = true;   ///< false: lockstep, and SYNC failed to come
    bool by_timer = false;      ///< the sensors' frame to go by failed to come
    FrameIntake::Taken taken{};
};

class Pacer {
  public:
    virtual ~Pacer() = default;
    /// Nothing once `stop` is set; seen within a period (timer) or kLongestWait (SYNC).
    [[nodiscard]] virtual std::optional<Wake> next(const std::atomic<bool>& stop) = 0;
};

/// Absolute deadlines of CLOCK_MONOTONIC; the controller's time is that clock.
class TimerPacer final : public Pacer {
  public:
    TimerPacer(Clock& clock, Time period, FrameIntake& intake) : clock_(clock), period_(period), intake_(intake) {}
    /// The first call starts the timer.
    [[nodiscard]] std::optional<Wake> next(const std::atomic<bool>& stop) override;

  private:
    Clock& clock_;
    Time period_;
    FrameIntake& intake_;
    std::optional<PeriodicTimer> timer_;
};

/// A rig's clock: one step for each frame of the sensors' last message in a period, as soon as it is there. So the
/// controller keeps the rig's time, and a measurement never waits for a timer. Its time is CLOCK_MONOTONIC.
///
/// A frame that does not come within one and a half periods of the last one is stepped without, and so is every period
/// after it until one comes. Steps are half a period apart at least, whatever the bus does: of several frames that
/// come at once the newest counts.
class SensorPacer final : public Pacer {
  public:
    /// The message to go by: of wheel, flywheel and pressure that which comes once in `period` and has the highest
    /// identifier, since the bus lets it through last. None: they all have other periods.
    [[nodiscard]] static std::optional<can::Role> message(const can::Layout& layout, Time period);

    SensorPacer(Clock& clock, Time period, can::Role message, can::Bus& bus, const can::ControllerPort& port, FrameIntake& intake);
    [[nodiscard]] std::optional<Wake> next(const std::atomic<bool>& stop) override;

  private:
    [[nodiscard]] std::uint32_t arrived() const;
    [[nodiscard]] Time reception() const;
    [[nodiscard]] Wake on_frame();
    [[nodiscard]] Wake on_silence(Time deadline);

    Clock& clock_;
    Time period_;
    can::Role message_;
    can::Bus& bus_;
    const can::ControllerPort& port_;
    FrameIntake& intake_;
    Time last_{};            ///< reception of the frame or, without one, the deadline that made the last step
    bool by_frame_ = false;  ///< which of them
    Time woke_{};
    bool started_ = false;
};

/// Lockstep: one step for each SYNC, and the controller's time is the number of steps before it times the
/// period, so that a run does not depend on the machine's speed.
///
/// Nothing happens before the first SYNC. When the next one fails to come within `timeout` (and up to kLongestWait), steps go on once a
/// period on the machine's clock until it does: the ages of the inputs grow, and the controller names what is
/// missing. While SYNC comes the clock is not asked before the step: a reading costs as much as one in a virtual
/// machine. A SYNC whose number does not follow the last one's counts as a missed period.
class SyncPacer final : public Pacer {
  public:
    static constexpr Time kLongestWait = can::Bus::kLongestWait;

    SyncPacer(Clock& clock, Time period, Time timeout, const can::ControllerPort& port, std::uint64_t sync_modulo, FrameIntake& intake);
    [[nodiscard]] std::optional<Wake> next(const std::atomic<bool>& stop) override;

  private:
    [[nodiscard]] Wake on_sync(const FrameIntake::Taken& taken);
    [[nodiscard]] bool follows_last();
    /// A rig that is not sure to be heard repeats its first SYNC: one number, one step.
    [[nodiscard]] bool repeats_last() const;

    Clock& clock_;
    Time period_;
    Time timeout_;
    const can::ControllerPort& port_;
    std::uint64_t sync_modulo_;
    FrameIntake& intake_;
    Time next_now_{};
    std::optional<Time> last_;  ///< first reading of the clock since the last step
    std::uint32_t last_number_ = 0;
    bool started_ = false;
    bool synchronised_ = false;
};

}  // namespace antiskid::host
