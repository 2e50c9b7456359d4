/// The rig's counterpart of ControllerPort: RigSample to frames; frames of the controller to a ControllerView. Freestanding.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/can/controller_view.hpp"
#include "firmware/can/frame_gate.hpp"
#include "firmware/can/layout.hpp"
#include "firmware/can/rig_sample.hpp"
#include "firmware/can/roles.hpp"
#include "firmware/can/schedule.hpp"

namespace antiskid::can {

class RigPort {
  public:
    /// Largest number of frames that due_frames() returns.
    static constexpr std::size_t kMaxFrames = 8;

    /// `layout` must outlive the port. `step` > 0 is the period at which due_frames() is called; `sends`: the roles that this program sends, e.g.
    /// kFromBridge if several programs share the rig's part.
    RigPort(const Layout& layout, control::Time step, std::span<const Role> sends = kFromRig);
    RigPort(const Layout&& layout, control::Time step, std::span<const Role> sends = kFromRig) = delete;

    /// Call once a step: writes the frames that are due to `out` and returns their number. Order: emergency stop while requested, wheel, flywheel,
    /// pressure, maneuver, heartbeat, load cells, maneuver state (also whenever phase or number has changed). SYNC is not among them. `out` needs
    /// room for kMaxFrames.
    [[nodiscard]] std::size_t due_frames(const RigSample& sample, std::span<Frame> out);

    /// Make one frame outside the cycle. Each call advances the message's alive counter.
    [[nodiscard]] Frame wheel(const SpeedSample& sample);
    [[nodiscard]] Frame flywheel(const SpeedSample& sample);
    [[nodiscard]] Frame pressure(float pressure_Pa);
    [[nodiscard]] Frame maneuver(const ManeuverSample& sample);
    [[nodiscard]] Frame heartbeat();
    [[nodiscard]] Frame emergency_stop();
    [[nodiscard]] Frame load_cells(const LoadCellSample& sample);
    /// This and sync(): only for layouts that have the message.
    [[nodiscard]] Frame maneuver_state(const ManeuverStateSample& sample);
    /// The frame carries `number` modulo its field.
    [[nodiscard]] Frame sync(std::uint32_t number);

    void accept(const Frame& frame);

    [[nodiscard]] const ControllerView& controller() const { return view_; }
    [[nodiscard]] const MessageStats& stats(Role role) const { return gate_.stats(role); }
    [[nodiscard]] std::uint32_t unknown_ids() const { return gate_.unknown_ids(); }

  private:
    [[nodiscard]] Frame speed(Role role, const SpeedSignals& signals, const SpeedSample& sample);
    [[nodiscard]] Frame protect(Role role, const Payload& payload);
    [[nodiscard]] bool due(Role role) const { return sends_[static_cast<std::size_t>(role)] && schedule_.due(role, step_index_); }
    [[nodiscard]] bool state_is_due(const ManeuverStateSample& sample) const;

    const Layout& layout_;
    Schedule schedule_;
    FrameGate gate_;
    ControllerView view_;
    std::array<E2eSender, kRoleCount> senders_{};
    std::array<bool, kRoleCount> sends_{};
    ManeuverStateSample last_state_;
    std::uint32_t step_index_ = 0;
};

}  // namespace antiskid::can
