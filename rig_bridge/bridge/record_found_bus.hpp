/// What the bus says when a bridge comes to a maneuver that a dead one left: whether the rim still turns tells what its brake took meanwhile.
#pragma once

#include <filesystem>

#include "rig_bridge/bridge/bridge_setup.hpp"

namespace rig::bridge {

/// Makes kFoundLog in `folder`, 0.3 s of the bus; nothing where it is there already, nobody sends, or the interface is not to be had.
void record_found_bus(const BridgeSetup& setup, const std::filesystem::path& folder);

}  // namespace rig::bridge
