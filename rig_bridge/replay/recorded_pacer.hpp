/// Reconstructs the controller's steps from a log: the time of each step and the frames known at it.
///
/// Lockstep (SYNC before the first valve command): each SYNC ends a sample, each recorded valve command answers the oldest
/// sample that has no answer yet, and the controller's time is the number of steps before it times the period, as in the
/// recorded run: the steps are exactly those. Before the first answer only the newest sample is used, because the controller was not running for the
/// older ones. A valve command without a sample is a step by the controller's own clock after SYNC failed to arrive.
///
/// Timer: each valve command ends a step; the frames before it in the log belong to it, and its stamp is the step's time. The controller itself read
/// the bus some tens of microseconds before its command: a frame that arrived in between is one step early here, and the ages of inputs are longer by
/// that time.
///
/// If the log begins while the controller was running, alive counters and the schedule of slow messages are set as at the first recorded command; the
/// controller itself starts from its initial state.
///
/// Up to three final valve commands with the safe current and without a sample are taken as the controller's closing commands.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/layout.hpp"
#include "firmware/host/pacer.hpp"
#include "rig_bridge/replay/frame_comparison.hpp"
#include "rig_bridge/replay/log_reader.hpp"

namespace rig::replay {

/// Alive counters of the messages sent at one recorded step; kNotSent: not sent, kUnknown: not known.
struct SentAtStep {
    static constexpr int kNotSent = -1;
    static constexpr int kUnknown = -2;
    std::array<int, antiskid::can::kRoleCount> counter{};

    SentAtStep() { counter.fill(kUnknown); }
    [[nodiscard]] int& operator[](antiskid::can::Role role) { return counter[static_cast<std::size_t>(role)]; }
    [[nodiscard]] int operator[](antiskid::can::Role role) const { return counter[static_cast<std::size_t>(role)]; }
};

/// The smallest number of steps before the first of `steps` with which counters and schedule agree: 0 for a controller that started
/// with the log. None if no number up to 100 000 does, i.e. frames are missing.
[[nodiscard]] std::optional<std::uint64_t> steps_before(const antiskid::can::Layout& layout, antiskid::control::Time period,
                                                        const std::vector<SentAtStep>& steps);

enum class ReplayClock : std::uint8_t { automatic, sync, timer };

struct PacerSettings {
    ReplayClock clock = ReplayClock::automatic;
    Time period{};
    float safe_current_mA = 0.0F;
};

class RecordedPacer final : public antiskid::host::Pacer {
  public:
    /// All must outlive the pacer. `log` must have been opened with `layout`.
    RecordedPacer(const PacerSettings& settings, const antiskid::can::Layout& layout, LogReader& log, antiskid::can::ControllerPort& port,
                  FrameComparison& comparison);

    [[nodiscard]] std::optional<antiskid::host::Wake> next(const std::atomic<bool>& stop) override;

    [[nodiscard]] bool lockstep() const { return lockstep_; }
    /// Steps without a SYNC in a lockstep log.
    [[nodiscard]] std::uint64_t unsynchronised() const { return unsynchronised_; }
    /// Samples without an answer, including those before the first answer.
    [[nodiscard]] std::uint64_t unanswered() const { return unanswered_; }
    /// Steps of the controller before the log begins, by its counters; none: cannot be determined.
    [[nodiscard]] std::optional<std::uint64_t> steps_before_log() const { return before_log_; }
    /// From the first valve command to the last, rig time in lockstep, stamps otherwise.
    [[nodiscard]] Time duration() const { return last_now_ - first_now_; }

  private:
    struct Sample {
        std::size_t frames = 0;  ///< of `frames_`, oldest first
        std::uint32_t number = 0;
    };
    [[nodiscard]] bool read(LogFrame& out);
    void rig_frame(const Frame& frame, bool sync);
    void drop_oldest_sample();
    /// Sets the port's schedule and counters as in the recorded controller at its first command in the log.
    void join_session(const Frame& first_valve);
    void look_ahead();
    [[nodiscard]] std::vector<SentAtStep> sent_ahead(const Frame& first_valve, bool valve_last) const;
    [[nodiscard]] bool is_closing(const LogFrame& valve);
    [[nodiscard]] bool carries_safe_current(const Frame& valve) const;
    [[nodiscard]] antiskid::host::Wake step(Time stamp);
    [[nodiscard]] bool follows_last(std::uint32_t number);
    std::size_t feed(std::size_t count, Time now);

    PacerSettings settings_;
    const antiskid::can::Layout& layout_;
    LogReader& log_;
    antiskid::can::ControllerPort& port_;
    FrameComparison& comparison_;

    std::deque<Frame> frames_;    // of the samples, then those after the last SYNC
    std::deque<Sample> samples_;  // not yet answered
    std::size_t loose_ = 0;       // frames after the last SYNC
    std::deque<LogFrame> ahead_;  // read to look for the end
    bool lockstep_ = false;
    bool started_ = false;
    bool ended_ = false;
    bool any_number_ = false;
    std::uint32_t last_number_ = 0;
    std::optional<std::uint64_t> before_log_;
    Time first_now_{};
    Time last_now_{};
    std::uint64_t steps_ = 0;
    std::uint64_t unsynchronised_ = 0;
    std::uint64_t unanswered_ = 0;
};

}  // namespace rig::replay
