/// Who talks on the rig's bus, before the bridge does.
#pragma once

#include "rig_bridge/bridge/preflight.hpp"

namespace rig::bridge {

/// For `length`; sends nothing.
[[nodiscard]] BusReception listen_to_bus(const BridgeSetup& setup, antiskid::can::Time length);

}  // namespace rig::bridge
