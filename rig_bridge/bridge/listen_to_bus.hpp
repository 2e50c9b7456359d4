/// Who talks on the rig's bus, before the bridge does.
#pragma once

#include "rig_bridge/bridge/preflight.hpp"

namespace rig {

/// For `length`; sends nothing.
[[nodiscard]] BusHeard listen_to_bus(const Setup& setup, antiskid::can::Time length);

}  // namespace rig
