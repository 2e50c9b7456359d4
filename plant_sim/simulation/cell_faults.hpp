/// What befalls a test cell, as a plan that is drawn, printed and made smaller.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rig_bridge/rig/quantities.hpp"
#include "rig_bridge/rig/sequencer.hpp"
#include "rig_bridge/wear/draw.hpp"

namespace plant_sim::simulation {

enum class CellFault : std::uint8_t {
    frames_lost,  ///< on their way to one party, as the next three
    frames_late,
    frames_doubled,
    frames_damaged,
    off_bus,        ///< one party's interface is down
    requests_lost,  ///< between bridge and PLC, as the next three
    answers_lost,
    answers_damaged,
    requests_doubled,
    plc_unreachable,  ///< connecting fails, too
    plc_frozen,       ///< answers, and its registers stay as they are
    interlock_open,
    controller_killed,
    controller_stopped,
    bridge_killed,
    bridge_stopped,
    bridge_hangs,  ///< its main loop; the client's thread goes on
};
inline constexpr std::array<std::string_view, 17> kCellFaultNames{
    "frames_lost",       "frames_late",        "frames_doubled",   "frames_damaged",  "off_bus",     "requests_lost",
    "answers_lost",      "answers_damaged",    "requests_doubled", "plc_unreachable", "plc_frozen",  "interlock_open",
    "controller_killed", "controller_stopped", "bridge_killed",    "bridge_stopped",  "bridge_hangs"};

enum class Party : std::uint8_t { rig, controller, bridge };
inline constexpr std::array<std::string_view, 3> kPartyNames{"rig", "controller", "bridge"};

struct PlannedFault {
    CellFault fault = CellFault::frames_lost;
    Party party = Party::rig;  ///< of the first five
    rig::Interlock interlock = rig::Interlock::emergency_stop_clear;
    double share = 1.0;  ///< of frames or requests
    // It begins `after_s` after the first time that this attempt, or a later one, has reached the phase.
    int attempt = 1;
    rig::Phase phase = rig::Phase::idle;
    double after_s = 0.0;
    double lasts_s = 0.0;
};
[[nodiscard]] std::string text(const PlannedFault& fault);

/// One to five.
[[nodiscard]] std::vector<PlannedFault> draw_faults(wear::Generator& draw);

}  // namespace plant_sim::simulation
