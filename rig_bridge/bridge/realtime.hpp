/// Requests real-time scheduling for the 10 ms loop; reports refusals and continues without it.
#pragma once

#include "firmware/host/realtime.hpp"
#include "rig_bridge/bridge/terminal.hpp"

namespace rig::bridge {

/// For the calling thread and those that it starts later.
inline void enter_realtime(int priority, Terminal& terminal) {
    if (priority == 0) return;
    for (const std::string& rejected : antiskid::host::enter_realtime({.priority = priority, .cpu = {}})) terminal.say("rig-bridge: " + rejected);
}

}  // namespace rig::bridge
