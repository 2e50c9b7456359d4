/// The rig's door to the bus, the mirror of ControllerPort: samples in, frames out; valve command and status
/// in. Freestanding.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/can/frame_gate.hpp"
#include "firmware/can/layout.hpp"
#include "firmware/can/rig_sample.hpp"
#include "firmware/can/schedule.hpp"

namespace antiskid::can {

/// What the rig knows of the controller. A member keeps its last accepted value.
struct ControllerView {
    control::Time command_received = control::kNever;
    float current_mA = 0.0F;  ///< newest accepted valve command
    control::Time status_received = control::kNever;
    control::State state = control::State::self_test;
    float slip = 0.0F;
    float slip_reference = 0.0F;
    float speed_mps = 0.0F;
    control::Time faults_received = control::kNever;
    control::FaultSet faults;
    control::Time heartbeat_received = control::kNever;
};

class RigPort {
  public:
    /// Most frames that due_frames() can give.
    static constexpr std::size_t kMostFrames = 7;

    /// `layout` must outlive the port. `step` > 0 is the period at which due_frames() is called.
    RigPort(const Layout& layout, control::Time step);
    RigPort(const Layout&& layout, control::Time step) = delete;

    /// Once a step: the frames due now, in this order: emergency stop while it is asked for, wheel, flywheel,
    /// pressure, maneuver, heartbeat, load cells. SYNC is not among them. Returns how many were written to
    /// `out`, which must have room for kMostFrames.
    [[nodiscard]] std::size_t due_frames(const RigSample& sample, std::span<Frame> out);

    /// One frame at once, outside the cycle. Each advances its alive counter.
    [[nodiscard]] Frame wheel(const SpeedSample& sample);
    [[nodiscard]] Frame flywheel(const SpeedSample& sample);
    [[nodiscard]] Frame pressure(float pressure_Pa);
    [[nodiscard]] Frame maneuver(const ManeuverSample& sample);
    [[nodiscard]] Frame heartbeat();
    [[nodiscard]] Frame emergency_stop();
    [[nodiscard]] Frame load_cells(const LoadCellSample& sample);
    /// Only where the layout has the message. Carries `number` modulo its field.
    [[nodiscard]] Frame sync(std::uint32_t number);

    void accept(const Frame& frame);

    [[nodiscard]] const ControllerView& controller() const { return view_; }
    [[nodiscard]] const MessageStats& stats(Role role) const { return gate_.stats(role); }
    [[nodiscard]] std::uint32_t unknown_ids() const { return gate_.unknown_ids(); }

  private:
    [[nodiscard]] Frame speed(Role role, const SpeedSignals& signals, const SpeedSample& sample);
    [[nodiscard]] Frame protect(Role role, const Payload& payload);
    /// False when a value has no meaning.
    [[nodiscard]] bool decode(Role role, const Payload& payload, control::Time received);

    const Layout& layout_;
    Schedule schedule_;
    FrameGate gate_;
    ControllerView view_;
    std::array<E2eSender, kRoleCount> senders_{};
    std::uint64_t step_index_ = 0;
};

}  // namespace antiskid::can
