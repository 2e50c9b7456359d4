/// The controller's state as received from the bus. Freestanding.
#pragma once

#include "firmware/can/layout.hpp"
#include "firmware/control/types.hpp"

namespace antiskid::can {

/// Each member keeps its last accepted value.
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

/// Copies the values of a checked frame of the controller into `view`. False, with `view` unchanged, if a code is undefined or the role is not one
/// that the controller sends.
[[nodiscard]] bool apply(const Layout& layout, Role role, const Payload& payload, control::Time received, ControllerView& view);

}  // namespace antiskid::can
