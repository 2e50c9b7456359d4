#include <array>
#include <cstddef>

#include "rig_bridge/rig/sequencer.hpp"

namespace rig {

std::string_view name(Phase phase) {
    constexpr std::array<std::string_view, kPhaseCount> kNames{"idle",    "spin_up",   "touchdown", "settling", "braking", "standstill",
                                                               "retract", "cool_down", "finished",  "aborting", "aborted"};
    const auto i = static_cast<std::size_t>(phase);
    return i < kNames.size() ? kNames[i] : "?";
}

std::string_view name(Abort abort) {
    constexpr std::array<std::string_view, kAbortCount> kNames{
        "none",        "requested",        "emergency_stop",    "guard_open",       "hydraulics_lost", "drive_fault",  "plc_silent",
        "plc_tripped", "command_rejected", "controller_silent", "controller_fault", "bus_lost",        "sensors_lost", "phase_timeout",
        "brake_hot",   "load_lost",        "foreign_command",   "overspeed",        "speed_mismatch",  "two_senders",  "bus_unread"};
    const auto i = static_cast<std::size_t>(abort);
    return i < kNames.size() ? kNames[i] : "?";
}

bool stops_controller(Abort abort) {
    switch (abort) {
        case Abort::emergency_stop:
        case Abort::guard_open:
        case Abort::hydraulics_lost:
        case Abort::drive_fault:
        case Abort::plc_silent:
        case Abort::plc_tripped:
        case Abort::controller_silent:
        case Abort::bus_lost:
        case Abort::sensors_lost:
        case Abort::load_lost:
        case Abort::foreign_command:
        case Abort::overspeed:
        case Abort::speed_mismatch:
        case Abort::two_senders:
        case Abort::bus_unread:
            return true;
        case Abort::none:
        case Abort::requested:
        case Abort::command_rejected:
        case Abort::controller_fault:
        case Abort::phase_timeout:
        case Abort::brake_hot:
            return false;
    }
    return true;
}

}  // namespace rig
