/// Faults of a test cell, as a plan that can be drawn, printed and reduced.
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
    frames_lost,  ///< on their way to `node`, as the next three
    frames_late,
    frames_doubled,
    frames_damaged,
    off_bus,        ///< one node's interface is down
    requests_lost,  ///< between bridge and PLC, as the next three
    answers_lost,
    answers_damaged,
    requests_doubled,
    plc_unreachable,  ///< connecting fails, too
    plc_frozen,       ///< answers, but its registers do not change
    interlock_open,
    controller_killed,
    controller_stopped,
    bridge_killed,
    bridge_stopped,
    bridge_hangs,    ///< its main loop; the threads of client and recorder go on
    clock_set,       ///< the wall clock of the bridge's computer; set back at the end
    power_cut,       ///< of the computer with bridge and controller, during an operation of its disk, as the next four
    killed_writing,  ///< the bridge, during a write
    disk_full,
    disk_refuses,
    disk_writes_short,
};
inline constexpr std::array<std::string_view, 23> kCellFaultNames{
    "frames_lost",       "frames_late",        "frames_doubled",   "frames_damaged",  "off_bus",          "requests_lost",
    "answers_lost",      "answers_damaged",    "requests_doubled", "plc_unreachable", "plc_frozen",       "interlock_open",
    "controller_killed", "controller_stopped", "bridge_killed",    "bridge_stopped",  "bridge_hangs",     "clock_set",
    "power_cut",         "killed_writing",     "disk_full",        "disk_refuses",    "disk_writes_short"};

enum class BusNode : std::uint8_t { rig, controller, bridge };
inline constexpr std::array<std::string_view, 3> kBusNodeNames{"rig", "controller", "bridge"};

struct PlannedFault {
    CellFault fault = CellFault::frames_lost;
    BusNode node = BusNode::rig;  ///< for the first five faults
    rig::Interlock interlock = rig::Interlock::emergency_stop_clear;
    double share = 1.0;  ///< of the affected frames or requests
    // It begins `after_s` after this attempt, or a later one, first reached `phase`.
    int attempt = 1;
    rig::Phase phase = rig::Phase::idle;
    double after_s = 0.0;
    double lasts_s = 0.0;  ///< for faults that end a program: until its restart
    double set_s = 0.0;    ///< step of the clock, of either sign
    std::uint64_t operation =
        1;  ///< of the disk, counted from the fault's beginning: the first that it may affect; the fault ends without one within kMaxWait_s
    std::uint64_t operations = 1;  ///< number of operations that find the disk full
};
inline constexpr double kMaxWait_s = 8.0;
[[nodiscard]] constexpr bool of_disk(CellFault fault) {
    return fault >= CellFault::power_cut;
}
[[nodiscard]] std::string text(const PlannedFault& fault);

/// Draws one to five faults.
[[nodiscard]] std::vector<PlannedFault> draw_faults(wear::Generator& draw);

}  // namespace plant_sim::simulation
