/// Decodes every message of the layout, whoever sent it, and keeps the newest values. For views, recordings and measurements; sends nothing.
/// Freestanding.
///
///     Observer observer(layout);
///     for (frames received) if (const auto role = observer.accept(frame)) ...   // observer.view() has it
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/can/controller_view.hpp"
#include "firmware/can/frame_gate.hpp"
#include "firmware/can/layout.hpp"
#include "firmware/can/rig_sample.hpp"
#include "firmware/can/sensor_decoder.hpp"
#include "firmware/control/types.hpp"

namespace antiskid::can {

/// Each member keeps its last accepted value, with Frame::received of its frame as time; kNever before the first. `rejected` of the inputs stays 0:
/// see Observer::stats().
struct BusView {
    control::SpeedInput wheel;
    control::SpeedInput flywheel;
    control::PressureInput pressure;
    control::ManeuverInput maneuver;
    control::Time rig_heartbeat_received = control::kNever;
    control::Time emergency_stop_received = control::kNever;
    control::Time sync_received = control::kNever;
    std::uint32_t sync_number = 0;  ///< as sent, modulo its field; 0 if the layout's SYNC has no number
    control::Time load_cells_received = control::kNever;
    LoadCellSample load_cells;
    control::Time maneuver_state_received = control::kNever;
    ManeuverStateSample maneuver_state;
    ControllerView controller;
};

class Observer {
  public:
    /// `layout` must outlive the observer.
    explicit Observer(const Layout& layout);
    explicit Observer(const Layout&& layout) = delete;

    /// The frame's role if it passed every check and is now in view(); none if its identifier is unknown or it was refused.
    std::optional<Role> accept(const Frame& frame);

    [[nodiscard]] const BusView& view() const { return view_; }
    [[nodiscard]] const MessageStats& stats(Role role) const { return gate_.stats(role); }
    [[nodiscard]] std::uint32_t unknown_ids() const { return gate_.unknown_ids(); }

  private:
    [[nodiscard]] bool decode(Role role, const Payload& payload, control::Time received);

    const Layout& layout_;
    FrameGate gate_;
    SpeedDecoder wheel_;
    SpeedDecoder flywheel_;
    BusView view_;
};

}  // namespace antiskid::can
