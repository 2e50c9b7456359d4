#include "rig_bridge/bridge/view_model.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "firmware/can/names.hpp"
#include "firmware/can/value_names.hpp"

namespace rig::bridge {

namespace {

double or_zero(double value) {
    return std::isfinite(value) ? value : 0.0;
}

std::string_view plc_state(const Moment& m) {
    if (m.plc.link != modbus::LinkState::connected) return name(m.plc.link);
    if (!m.inputs.plc_fresh) return "silent";
    return m.inputs.plc_ready ? "ready" : "tripped";
}

}  // namespace

ViewModel view_of(const Moment& m, const Freshness& limits) {
    ViewModel v;
    v.phase = m.outputs.phase;
    v.abort = m.outputs.abort;
    v.rim_mps = m.bus.rim_mps;
    v.wheel_mps = m.inputs.wheel_rim_mps;
    v.slip = m.inputs.wheel_on_rim ? m.bus.slip : 0.0;
    v.pressure_Pa = m.inputs.pressure_Pa;
    v.load_N = or_zero(m.plc.value(Measured::vertical_load_N));
    v.torque_Nm = or_zero(m.plc.value(Measured::brake_torque_Nm));
    v.temperature_C = or_zero(m.plc.value(Measured::brake_temperature_C));
    const auto& controller = m.bus.view.controller;
    v.controller = m.inputs.controller_fresh           ? antiskid::can::kStateNames[static_cast<std::size_t>(controller.state)]
                   : m.bus.controller_rejected.empty() ? std::string_view("silent")
                                                       : std::string_view("rejected");
    v.plc = plc_state(m);
    v.bus = !m.inputs.bus_up ? "down" : m.inputs.bus_read ? "up" : "not read";
    if (m.inputs.controller_fresh) v.faults = antiskid::can::fault_names(controller.faults);
    v.frames = m.bus.frames;
    v.dropped = m.bus.dropped;
    v.note = note_of(m);
    if (m.resetting) v.note = "resets the PLC";
    if (v.note.empty() && !plc_fresh(m.plc, limits)) v.note = "no fresh registers";
    return v;
}

std::optional<double> rim_speed_mps(const Moment& m) {
    std::optional<double> rim_mps;
    if (m.inputs.plc_fresh) rim_mps = m.inputs.flywheel_mps;
    if (m.inputs.bus_up && m.inputs.sensors_fresh) rim_mps = std::max(rim_mps.value_or(0.0), m.inputs.rim_mps);
    return rim_mps;
}

std::string rim_text(std::optional<double> rim_mps, double standstill_mps) {
    if (!rim_mps) return "nobody says how fast the rim turns: take it for turning";
    if (*rim_mps < standstill_mps) return "the rim stands";
    return fmt::format("the rim still turns, at {:.2f} m/s: the guard stays closed until it stands", *rim_mps);
}

std::string second_sender_text(const BusNow& bus) {
    if (!bus.two_controllers.empty()) {
        const std::string rejected = bus.controller_rejected.empty() ? "" : "; heard but refused: " + bus.controller_rejected;
        return fmt::format("two controllers talk on the bus: {}{}", bus.two_controllers, rejected);
    }
    if (!bus.two_bridges.empty()) return "two bridges command on the bus: " + bus.two_bridges;
    return {};
}

std::string senders_text(const BusNow& bus, bool fresh) {
    std::string second = second_sender_text(bus);
    if (!second.empty() || fresh || bus.controller_rejected.empty()) return second;
    return "the controller is heard but refused: " + bus.controller_rejected;
}

std::string note_of(const Moment& m) {
    if (!m.bus.up && !m.bus.error.empty()) return m.bus.error;
    if (std::string senders = senders_text(m.bus, m.inputs.controller_fresh); !senders.empty()) return senders;
    if (m.plc.link != modbus::LinkState::connected && !m.plc.error.empty()) return "PLC: " + m.plc.error;
    if (m.inputs.foreign_command) return "somebody else commands the PLC: commit " + std::to_string(m.plc.foreign_commit) + " is not the bridge's";
    if (m.plc.command == modbus::CommandState::unsendable) return "PLC command: " + m.plc.command_error;
    if (m.plc.command == modbus::CommandState::rejected) return "PLC refused the command with commit " + std::to_string(m.plc.commit);
    return {};
}

}  // namespace rig::bridge
