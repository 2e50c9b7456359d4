/// Translates between bus and controller: frames to control::Sensors, control::Command to frames. Freestanding: no heap, exception, clock or
/// operating system; every call is bounded.
///
/// A frame that fails a check is counted (stats) and not used; for wheel, flywheel, pressure and maneuver it also increases that input's `rejected`.
/// One period:
///
///     for (frames received) port.accept(frame);
///     port.note_link(bus.status());
///     const Command command = controller.step(port.sensors(), now);
///     port.clear_one_shots();
///     const auto due = span.first(port.due_frames(command, span));
///     if (bus.send_all(due) == 0 && !due.empty()) port.note_command_unsent();
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/can/bus.hpp"
#include "firmware/can/frame_gate.hpp"
#include "firmware/can/layout.hpp"
#include "firmware/can/schedule.hpp"
#include "firmware/can/sensor_decoder.hpp"
#include "firmware/control/types.hpp"

namespace antiskid::can {

class ControllerPort {
  public:
    /// Largest number of frames that due_frames() returns.
    static constexpr std::size_t kMaxFrames = 5;

    /// `layout` must outlive the port. `step` > 0 is the control period.
    ControllerPort(const Layout& layout, control::Time step);
    ControllerPort(const Layout&& layout, control::Time step) = delete;

    /// The age of the frame's values is counted from `frame.received`; in lockstep, set it to the lockstep time first.
    void accept(const Frame& frame);

    [[nodiscard]] const control::Sensors& sensors() const { return sensors_; }

    /// Call once a period. Sets Sensors::bus_off while the link is down or bus-off, and for one step if it was so only between two calls.
    void note_link(const LinkStatus& status);
    /// Adds to Sensors::missed_periods, which counts until clear_one_shots().
    void note_missed_periods(std::uint32_t count) { sensors_.missed_periods += count; }
    /// Sets Sensors::command_unsent until clear_one_shots(): the bus did not take the last valve command.
    void note_command_unsent() { sensors_.command_unsent = true; }
    /// Call after each step, so that emergency_stop, missed_periods and command_unsent are reported only once.
    void clear_one_shots();

    /// SYNC frames accepted since start, and the number in the newest one (0 if the layout's SYNC has no number).
    [[nodiscard]] std::uint32_t sync_count() const { return stats(Role::sync).accepted; }
    [[nodiscard]] std::uint32_t sync_number() const { return sync_number_; }

    /// Call once a period: writes the frames that are due to `out`, the valve command first, and returns their number. `out` needs room for
    /// kMaxFrames.
    [[nodiscard]] std::size_t due_frames(const control::Command& command, std::span<Frame> out);

    /// Make one frame outside the cycle, e.g. the closing valve commands at exit. Each call advances the message's alive counter.
    [[nodiscard]] Frame valve_command(float current_mA);
    [[nodiscard]] Frame status(const control::Command& command);
    [[nodiscard]] Frame faults(control::FaultSet faults);
    /// Only for layouts that have the message.
    [[nodiscard]] Frame road(const control::RoadEstimate& road);
    [[nodiscard]] Frame heartbeat();

    [[nodiscard]] const MessageStats& stats(Role role) const { return gate_.stats(role); }
    /// Frames that are no input of the controller, including its own messages sent by another node.
    [[nodiscard]] std::uint32_t unknown_ids() const { return gate_.unknown_ids(); }

  private:
    /// False if a code is undefined.
    [[nodiscard]] bool decode(Role role, const Payload& payload, control::Time received);
    void count_rejected(Role role);
    [[nodiscard]] Frame protect(Role role, const Payload& payload);

    const Layout& layout_;
    Schedule schedule_;
    FrameGate gate_;
    control::Sensors sensors_;
    SpeedDecoder wheel_;
    SpeedDecoder flywheel_;
    std::array<E2eSender, kRoleCount> senders_{};
    std::uint32_t sync_number_ = 0;
    std::uint32_t bus_off_events_ = 0;
    std::uint32_t step_index_ = 0;
};

}  // namespace antiskid::can
