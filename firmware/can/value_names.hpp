/// Names of the codes on the bus, as written in value tables and bindings. The array index is the code.
#pragma once

#include <array>
#include <string_view>

#include "firmware/control/types.hpp"

namespace antiskid::can {

inline constexpr std::array<std::string_view, control::kLawCount> kLawNames{"wheel_slip", "deceleration",  "open_loop",
                                                                            "threshold",  "pressure_bias", "peak_slip"};

/// Phases of a maneuver, see rig_bridge/rig/sequencer.hpp.
inline constexpr std::array<std::string_view, 11> kPhaseNames{"idle",    "spin_up",   "touchdown", "settling", "braking", "standstill",
                                                              "retract", "cool_down", "finished",  "aborting", "aborted"};

inline constexpr std::array<std::string_view, control::kStateCount> kStateNames{"self_test", "standby",      "armed",    "touchdown_protection",
                                                                                "braking",   "locked_wheel", "drop_out", "safe"};

inline constexpr std::array<std::string_view, control::kFaultCount> kFaultNames{
    "wheel_lost",      "wheel_corrupt",        "wheel_range",    "wheel_rate",       "wheel_stuck",
    "flywheel_lost",   "flywheel_corrupt",     "flywheel_range", "flywheel_rate",    "flywheel_stuck",
    "pressure_lost",   "pressure_corrupt",     "pressure_range", "pressure_rate",    "pressure_stuck",
    "speeds_disagree", "pressure_off_command", "maneuver_lost",  "maneuver_corrupt", "maneuver_range",
    "heartbeat_lost",  "emergency_stop",       "bus_off",        "overrun",          "lock_persists",
    "self_test_failed"};

}  // namespace antiskid::can
