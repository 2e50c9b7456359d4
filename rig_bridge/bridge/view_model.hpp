/// Makes the view of one step of the main loop. Pure.
#pragma once

#include <optional>
#include <string>

#include "rig_bridge/bridge/node.hpp"
#include "rig_bridge/bridge/view.hpp"

namespace rig::bridge {

/// The caller fills in scenario, campaign and times.
[[nodiscard]] ViewModel view_of(const Moment& moment, const Freshness& limits);

/// Errors reported by PLC client or bus; empty while both work.
[[nodiscard]] std::string note_of(const Moment& moment);

/// Reports a second controller or bridge, with the evidence; empty: neither.
[[nodiscard]] std::string second_sender_text(const BusNow& bus);

/// The same, or why the frames of a controller that is not `fresh` are refused; empty: neither applies.
[[nodiscard]] std::string senders_text(const BusNow& bus, bool fresh);

/// Rim speed, m/s, the faster of PLC and encoder on the bus, of those that are fresh; none: neither is.
[[nodiscard]] std::optional<double> rim_speed_mps(const Moment& moment);
/// State of the rim after an abort, for people.
[[nodiscard]] std::string rim_text(std::optional<double> rim_mps, double standstill_mps);

}  // namespace rig::bridge
