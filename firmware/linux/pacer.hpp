/// What makes the loop go round: the machine's timer, or SYNC. Waits for the next period and takes in the
/// frames that belong to it.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>

#include "firmware/linux/clock.hpp"
#include "firmware/linux/frame_intake.hpp"
#include "firmware/linux/periodic_timer.hpp"

namespace antiskid::rt {

struct Wake {
    Time now{};                 ///< for the controller
    Time woke{};                ///< on the machine's clock
    Time latency{};             ///< from what should have woken the loop to `woke`
    std::uint64_t skipped = 0;  ///< periods missed since the last wake-up
    bool synchronised = true;
    FrameIntake::Taken taken;
};

class Pacer {
  public:
    virtual ~Pacer() = default;
    /// Nothing once `stop` is set; seen within a period (timer) or kLongestWait (SYNC).
    [[nodiscard]] virtual std::optional<Wake> next(const std::atomic<bool>& stop) = 0;
};

/// A rig's clock: absolute deadlines of CLOCK_MONOTONIC; the controller's time is that clock.
class TimerPacer final : public Pacer {
  public:
    TimerPacer(Clock& clock, Time period, FrameIntake& intake)
        : clock_(clock), period_(period), intake_(intake) {}
    /// The first call starts the timer.
    [[nodiscard]] std::optional<Wake> next(const std::atomic<bool>& stop) override;

  private:
    Clock& clock_;
    Time period_;
    FrameIntake& intake_;
    std::optional<PeriodicTimer> timer_;
};

/// Lockstep: one step for each SYNC, and the controller's time is the number of steps before it times the
/// period, so that a run does not depend on the machine's speed.
///
/// Nothing happens before the first SYNC. When the next one fails to come within `timeout`, steps go on once a
/// period on the machine's clock until it does: the ages of the inputs grow, and the controller names what is
/// missing. A SYNC whose number does not follow the last one's counts as a missed period.
class SyncPacer final : public Pacer {
  public:
    static constexpr Time kLongestWait = std::chrono::milliseconds{20};

    SyncPacer(Clock& clock, Time period, Time timeout, can::Bus& bus, const can::ControllerPort& port,
              std::uint64_t sync_modulo, FrameIntake& intake);
    [[nodiscard]] std::optional<Wake> next(const std::atomic<bool>& stop) override;

  private:
    [[nodiscard]] Wake on_sync(const FrameIntake::Taken& taken);
    [[nodiscard]] bool follows_last();
    /// A rig that is not sure to be heard repeats its first SYNC: one number, one step.
    [[nodiscard]] bool repeats_last() const;

    Clock& clock_;
    Time period_;
    Time timeout_;
    can::Bus& bus_;
    const can::ControllerPort& port_;
    std::uint64_t sync_modulo_;
    FrameIntake& intake_;
    Time next_now_{};
    Time last_woke_{};
    std::uint32_t last_number_ = 0;
    bool started_ = false;
    bool synchronised_ = false;
};

}  // namespace antiskid::rt
