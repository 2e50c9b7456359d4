/// The controller's door to the bus: frames in, control::Sensors out; control::Command in, frames out.
/// Freestanding: no heap, exception, clock or operating system; every call is bounded.
///
/// A frame that fails a check is counted (stats) and not used; for wheel, flywheel, pressure and maneuver it
/// is also counted in `rejected` of that input. One period:
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
    /// Most frames that due_frames() can give.
    static constexpr std::size_t kMaxFrames = 5;

    /// `layout` must outlive the port. `step` > 0 is the control period.
    ControllerPort(const Layout& layout, control::Time step);
    ControllerPort(const Layout&& layout, control::Time step) = delete;

    /// `frame.received` becomes the age of what it carries: in lockstep put the logical time there first.
    void accept(const Frame& frame);

    [[nodiscard]] const control::Sensors& sensors() const { return sensors_; }

    /// Once a period. Sensors::bus_off while the link is down or bus-off, and for one step after it was in
    /// between.
    void note_link(const LinkStatus& status);
    /// Sensors::missed_periods until clear_one_shots().
    void note_missed_periods(std::uint32_t count) { sensors_.missed_periods += count; }
    /// Sensors::command_unsent until clear_one_shots(): the bus did not take the last valve command.
    void note_command_unsent() { sensors_.command_unsent = true; }
    /// After each step: emergency_stop, missed_periods and command_unsent are reported once.
    void clear_one_shots();

    /// SYNC frames accepted since start, and what the newest carried (0 when this layout's SYNC carries
    /// nothing).
    [[nodiscard]] std::uint32_t sync_count() const { return stats(Role::sync).accepted; }
    [[nodiscard]] std::uint32_t sync_number() const { return sync_number_; }

    /// Once a period: what is due now, the valve command first. Returns how many were written to `out`, which
    /// must have room for kMaxFrames.
    [[nodiscard]] std::size_t due_frames(const control::Command& command, std::span<Frame> out);

    /// One frame at once, outside the cycle (the last command at exit is a valve command). Each advances its
    /// alive counter.
    [[nodiscard]] Frame valve_command(float current_mA);
    [[nodiscard]] Frame status(const control::Command& command);
    [[nodiscard]] Frame faults(control::FaultSet faults);
    /// Only where the layout has the message.
    [[nodiscard]] Frame road(const control::RoadEstimate& road);
    [[nodiscard]] Frame heartbeat();

    [[nodiscard]] const MessageStats& stats(Role role) const { return gate_.stats(role); }
    /// Frames that the controller has no use for, its own messages sent by somebody else among them.
    [[nodiscard]] std::uint32_t unknown_ids() const { return gate_.unknown_ids(); }

  private:
    /// False when a value has no meaning.
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
