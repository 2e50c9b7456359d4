/// From one step of the main loop to what people see of it. Pure.
#pragma once

#include <string>

#include "rig_bridge/bridge/node.hpp"
#include "rig_bridge/bridge/view.hpp"

namespace rig {

/// Scenario, campaign and times are the caller's.
[[nodiscard]] ViewModel view_of(const Moment& moment, const Freshness& limits);

/// What keeps PLC or bus from working, as they say it; empty while both work.
[[nodiscard]] std::string note_of(const Moment& moment);

}  // namespace rig
