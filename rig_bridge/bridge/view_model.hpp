/// From one step of the main loop to what people see of it. Pure.
#pragma once

#include <optional>
#include <string>

#include "rig_bridge/bridge/node.hpp"
#include "rig_bridge/bridge/view.hpp"

namespace rig::bridge {

/// Scenario, campaign and times are the caller's.
[[nodiscard]] ViewModel view_of(const Moment& moment, const Freshness& limits);

/// What keeps PLC or bus from working, as they say it; empty while both work.
[[nodiscard]] std::string note_of(const Moment& moment);

/// That a second controller or bridge sends, and what shows it; empty: neither does.
[[nodiscard]] std::string second_sender_text(const BusNow& bus);

/// The same, or why the frames of a controller that is not `fresh` are refused; empty: there is nothing to say.
[[nodiscard]] std::string senders_text(const BusNow& bus, bool fresh);

/// Rim speed, m/s, by PLC and encoder on the bus, the faster of those that are heard; none: neither is.
[[nodiscard]] std::optional<double> rim_speed_mps(const Moment& moment);
/// How the rim is left, for people.
[[nodiscard]] std::string rim_text(std::optional<double> rim_mps, double standstill_mps);

}  // namespace rig::bridge
