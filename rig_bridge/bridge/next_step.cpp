#include "rig_bridge/bridge/next_step.hpp"

#include <fmt/core.h>

#include <array>
#include <cstddef>

#include "firmware/can/value_names.hpp"

namespace rig::bridge {

using antiskid::control::Fault;
using antiskid::control::FaultSet;
using antiskid::control::kFaultCount;
using rig::Abort;
using rig::Phase;

namespace {

/// In the order of rig::Abort.
constexpr std::array<NextStep, rig::kAbortCount> kAborts{{
    {"nothing", "nothing"},
    {"you requested it", "start again when you are ready"},
    {"the emergency stop was pressed, or its circuit opened", "find out who pressed it and why; release it, then start again"},
    {"the guard opened", "find out who opened it; nobody inside, close it, then start again"},
    {"the hydraulic supply is not ready", "pump, oil level, filter, leaks; start again when the supply pressure is steady"},
    {"the flywheel's drive reports a fault", "read the drive's own display, clear the fault there, then start again"},
    {"no new reading from the PLC within the times of config/bridge.toml, or its watchdog stands still",
     "is the PLC in stop mode? otherwise check cable, switch and address; rig-bridge preflight checks each of them"},
    {"the PLC tripped by itself", "read the PLC's own diagnosis first; start again when it shows no error"},
    {"the PLC rejected a command or did not confirm it in time, or the sledge is out while the drive pulls",
     "compare the limits of the PLC's program with the scenario; check the sledge's switch and the load of the link"},
    {"no valid status frame from the controller",
     "is antiskid-controller running? its log says why it ended; restart it; if frames come and are rejected, check binding and cable"},
    {"the controller went to its safe state, or was not armed when it had to be",
     "correct the fault that is named with it; if none is named, read the controller's log"},
    {"the CAN interface is down or bus-off", "termination, bit rate, cable; ip -details link show prints its state"},
    {"an encoder or the pressure transducer stopped sending, or sends values that are not numbers",
     "check its cable, power and node; candump shows which is missing"},
    {"a phase took longer than its limit", "find out why its condition was not met; limits are in config/sequencer.toml"},
    {"the brake was above brake_on_limit_C before brake-on", "wait until it is colder; look for a brake that drags"},
    {"during braking the load left its band, or the wheel left the rim",
     "check loading device, sledge and load cell; inspect tyre and rim before the next maneuver"},
    {"somebody else commanded the PLC",
     "find the other Modbus client (a second bridge, a panel, a script) and take it off the network; check what it commanded before you start again"},
    {"the flywheel turned faster than this maneuver can require",
     "wait until it has slowed down; then compare drive, its scaling and the register map with the scenario"},
    {"PLC and encoder on the bus differ in the rim's speed",
     "check teeth, radius and scaling of both; a hand tachometer shows which is wrong; do not brake before they agree"},
    {"two controllers, or two bridges, send on the bus",
     "find the second one (pgrep -a antiskid-contro, pgrep -a rig-bridge, other nodes) and end it; a gateway that repeats frames looks the same"},
    {"rig-bridge itself did not read the CAN bus for too long",
     "find out what else keeps this computer or its disk busy (top, iostat) and stop it; give rig-bridge real-time priority"},
}};

/// In the order of antiskid::control::Fault; conditions and times: docs/user/faults.md.
constexpr std::array<NextStep, kFaultCount> kFaults{{
    {"the wheel's encoder is not heard, or is heard late", "cable, power, binding; check the bus with candump"},
    {"frames of the wheel's encoder come and are rejected", "a disturbed bus, two senders, a wrong data ID"},
    {"the wheel's speed is out of range", "number of teeth; a disturbed pick-up"},
    {"the wheel's speed jumps", "a loose pick-up, missing teeth"},
    {"the wheel's encoder shows no edge while the rig turns", "encoder dead, or the wheel seized: turn it by hand"},
    {"the flywheel's encoder is not heard, or is heard late", "cable, power, binding; check the bus with candump"},
    {"frames of the flywheel's encoder come and are rejected", "a disturbed bus, two senders, a wrong data ID"},
    {"the flywheel's speed is out of range", "number of teeth; a disturbed pick-up"},
    {"the flywheel's speed jumps, or rises during braking", "a loose pick-up, missing teeth; a drive that still pulls"},
    {"the flywheel's encoder shows too low a speed or no edge while the rig turns", "encoder dead, or its shaft broken"},
    {"the pressure is not heard, or is heard late", "cable, power, binding; check the bus with candump"},
    {"pressure frames come and are rejected", "a disturbed bus, two senders, a wrong data ID"},
    {"the pressure reads outside its range", "transducer broken, or its range is another"},
    {"the pressure jumps", "a loose contact, noise"},
    {"the pressure reading stays the same although the pressure must have changed", "transducer frozen: replace it"},
    {"the speeds of wheel and rim disagree, or the wheel slips more than commanded",
     "number of teeth, radius, slipping encoder drive; a brake that drags"},
    {"the pressure does not follow the valve command", "valve stuck, no supply, leak, air; wrong valve map"},
    {"the maneuver command stopped", "the bridge died or stands still: read its log"},
    {"maneuver commands come and are rejected", "a disturbed bus, two senders: is a second bridge running?"},
    {"a commanded value is out of its range or not a number", "scaling in the scenario or the binding"},
    {"the rig's heartbeat stopped", "the bridge died or stands still: read its log"},
    {"an emergency stop frame came", "somebody pressed it, or the bridge sent it: see the abort cause"},
    {"the CAN interface is bus-off or down", "bit rate, termination; ip link set can0 up"},
    {"the controller's computer missed its periods", "read its latency histogram; run antiskid-controller --check"},
    {"the wheel stays locked although the brake is released, or locks again and again",
     "a seized brake, a burst tyre; sensor readings or commands too late"},
    {"there was pressure at rest, before arming", "valve leaks or sticks; wait until the pressure is gone"},
}};

/// In the order of rig::Phase.
constexpr std::array<std::string_view, rig::kPhaseCount> kAwaited{
    "PLC ready, interlocks good, controller in standby, sledge back, no pressure, rim not above the set-point",
    "the set-point held within speed_tolerance_mps, and the controller armed",
    "the wheel on the rim",
    "wheel and rim alike, the load in its band, and the rim down to the prescribed speed",
    "the rim at standstill",
    "the pressure gone",
    "the sledge back",
    "the brake at cool_to_C",
    "nothing",
    "the sledge back and the pressure gone",
    "nothing",
};

}  // namespace

NextStep next_step(Abort abort) {
    return kAborts[static_cast<std::size_t>(abort)];
}

NextStep next_step(Fault fault) {
    return kFaults[static_cast<std::size_t>(fault)];
}

std::string_view awaited(Phase phase) {
    return kAwaited[static_cast<std::size_t>(phase)];
}

std::string advice(Abort abort, Phase phase, FaultSet faults) {
    const NextStep step = next_step(abort);
    std::string text = fmt::format("ABORT {} in {}: {}", name(abort), name(phase), step.happened);
    if (abort == Abort::phase_timeout) text += fmt::format(", waiting for {}", awaited(phase));
    text += fmt::format(". Next: {}", step.next);
    if (abort != Abort::controller_fault) return text;
    for (std::size_t i = 0; i < kFaultCount; ++i) {
        const auto fault = static_cast<Fault>(i);
        if (!faults.contains(fault)) continue;
        text += fmt::format("\n  {}: {}. Next: {}", antiskid::can::kFaultNames[i], next_step(fault).happened, next_step(fault).next);
    }
    return text;
}

}  // namespace rig::bridge
