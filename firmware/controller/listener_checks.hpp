/// What the listener heard, judged.
#pragma once

#include "firmware/controller/check.hpp"
#include "firmware/controller/listener.hpp"

namespace antiskid::controller {

/// Present, fresh, undamaged, plausible: a check for each message that the controller lives on, one for what the sensors say while the
/// rig is at rest, one for the link, one for a second controller. What the bridge sends may be absent: a warning.
[[nodiscard]] Checks frame_checks(const Reception& reception, const controller::ControllerSetup& setup, const std::string& interface);
/// The same, where nothing could be heard: all skipped.
[[nodiscard]] Checks frame_checks_skipped(const controller::ControllerSetup& setup, const std::string& why);

/// Latency, work and missed periods of the loop.
[[nodiscard]] Checks timing_checks(const Reception& reception, control::Time period);

/// Why the valve may not be moved now; empty: wheel and flywheel at rest, no pressure, every sensor good, nobody else commands.
[[nodiscard]] std::string why_not_to_move_the_valve(const Reception& reception, const control::Config& config);

}  // namespace antiskid::controller
