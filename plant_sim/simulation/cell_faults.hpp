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
    bridge_hangs,    ///< its main loop; the threads of client and recorder go on
    clock_set,       ///< the wall clock of the bridge's computer, and set back when it is over
    power_cut,       ///< of the computer with bridge and controller, in an operation of its disk, as the next four
    killed_writing,  ///< the bridge
    disk_full,
    disk_refuses,
    disk_writes_short,
};
inline constexpr std::array<std::string_view, 23> kCellFaultNames{
    "frames_lost",       "frames_late",        "frames_doubled",   "frames_damaged",  "off_bus",          "requests_lost",
    "answers_lost",      "answers_damaged",    "requests_doubled", "plc_unreachable", "plc_frozen",       "interlock_open",
    "controller_killed", "controller_stopped", "bridge_killed",    "bridge_stopped",  "bridge_hangs",     "clock_set",
    "power_cut",         "killed_writing",     "disk_full",        "disk_refuses",    "disk_writes_short"};

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
    double lasts_s = 0.0;          ///< of what ends a program: until it is started again
    double set_s = 0.0;            ///< the clock, forward or back
    std::uint64_t operation = 1;   ///< of the disk, counted from when it begins: the first that it befalls; it waits for that for kPatience_s
    std::uint64_t operations = 1;  ///< that find the disk full
};
inline constexpr double kPatience_s = 8.0;
[[nodiscard]] constexpr bool of_disk(CellFault fault) {
    return fault >= CellFault::power_cut;
}
[[nodiscard]] std::string text(const PlannedFault& fault);

/// One to five.
[[nodiscard]] std::vector<PlannedFault> draw_faults(wear::Generator& draw);

}  // namespace plant_sim::simulation
