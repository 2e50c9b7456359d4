/// From one step of the main loop to what the panel shows of it. Pure.
#pragma once

#include <optional>
#include <string>

#include "rig_bridge/bridge/hold.hpp"
#include "rig_bridge/bridge/node.hpp"
#include "rig_bridge/bridge/view.hpp"
#include "rig_bridge/panel/live_feed.hpp"

namespace rig::bridge {

/// What is old or silent is NaN.
[[nodiscard]] panel::LiveSample live_sample(const Moment& moment);

/// States, interlocks, and what is wrong in plain words with what to do next, as one JSON object:
/// {"facts":{label:text,...},"interlocks":{name:good,...},"alarms":[{"name","happened","next"},...],
/// "campaign":name(HoldStatus)}. `campaign`: none for a single maneuver, "campaign" is null then.
[[nodiscard]] std::string panel_state(const ViewModel& view, const Moment& moment, std::optional<HoldStatus> campaign);

}  // namespace rig::bridge
