/// What others on the bus know of the controller. Freestanding.
#pragma once

#include "firmware/can/layout.hpp"
#include "firmware/control/types.hpp"

namespace antiskid::can {

/// A member keeps its last accepted value.
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
    control::Time road_received = control::kNever;
    control::RoadEstimate road;
    control::Time heartbeat_received = control::kNever;
};

/// Takes over a frame of the controller that passed its checks. False, with `view` unchanged, when a value
/// has no meaning or the role is none of the controller's.
[[nodiscard]] bool apply(const Layout& layout, Role role, const Payload& payload, control::Time received, ControllerView& view);

}  // namespace antiskid::can
