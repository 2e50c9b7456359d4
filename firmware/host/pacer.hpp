/// Starts each step of the loop: by a sensor frame, the machine's timer, or SYNC. Waits for the next period and takes in its frames.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "firmware/host/clock.hpp"
#include "firmware/host/frame_intake.hpp"
#include "firmware/host/periodic_timer.hpp"

namespace antiskid::host {

struct Wake {
    Time now{};                 ///< for the controller
    Time woke{};                ///< on the machine's clock; in lockstep the reception of SYNC
    Time latency{};             ///< from the event that should have woken the loop to `woke`
    std::uint64_t skipped = 0;  ///< periods missed since the last wake-up
    bool synchronised = true;   ///< false: lockstep, and SYNC did not arrive
    bool by_timer = false;      ///< the sensor frame did not arrive, the step was started by the timer
    FrameIntake::Taken taken{};
};

class Pacer {
  public:
    virtual ~Pacer() = default;
    /// Waits for the next step; none once `stop` is set, which is noticed within a period (timer) or kLongestWait (SYNC).
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

/// Follows the rig's clock: one step for each frame of the sensors' last message in a period, as soon as it arrives, so that a measurement never
/// waits for a timer. The controller's time is CLOCK_MONOTONIC.
///
/// If no frame arrives within one and a half periods of the last one, the step is taken without it, and then one step per period until a frame
/// arrives. Steps are at least half a period apart; of several frames that arrive together the newest counts.
class SensorPacer final : public Pacer {
  public:
    /// The message that starts a step: of wheel, flywheel and pressure, the one with cycle time `period` and the highest identifier, which the bus
    /// transmits last. None: no such message has this cycle time.
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
    Time last_{};            ///< reception of the frame, or without one the deadline, that started the last step
    bool by_frame_ = false;  ///< whether it was a frame
    Time woke_{};
    bool started_ = false;
};

/// Lockstep: one step for each SYNC. The controller's time is the number of earlier steps times the period, so that a run does not depend on the
/// machine's speed.
///
/// No step is taken before the first SYNC. If the next SYNC does not arrive within `timeout` (plus up to kLongestWait), steps continue once a period
/// on the machine's clock until it does: the inputs age, and the controller reports which are missing. While SYNC arrives, the clock is not read
/// before a step: in a virtual machine that costs as much as a step. A SYNC number that does not follow the last one counts as a missed period.
class SyncPacer final : public Pacer {
  public:
    static constexpr Time kLongestWait = can::Bus::kLongestWait;

    SyncPacer(Clock& clock, Time period, Time timeout, const can::ControllerPort& port, std::uint64_t sync_modulo, FrameIntake& intake);
    [[nodiscard]] std::optional<Wake> next(const std::atomic<bool>& stop) override;

  private:
    [[nodiscard]] Wake on_sync(const FrameIntake::Taken& taken);
    [[nodiscard]] bool follows_last();
    /// A rig repeats its first SYNC until it is answered; the repeats must not start further steps.
    [[nodiscard]] bool repeats_last() const;

    Clock& clock_;
    Time period_;
    Time timeout_;
    const can::ControllerPort& port_;
    std::uint64_t sync_modulo_;
    FrameIntake& intake_;
    Time next_now_{};
    std::optional<Time> last_;  ///< first clock reading since the last step
    std::uint32_t last_number_ = 0;
    bool started_ = false;
    bool synchronised_ = false;
};

}  // namespace antiskid::host
