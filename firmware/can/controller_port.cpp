#include "firmware/can/controller_port.hpp"

#include "firmware/can/roles.hpp"

namespace antiskid::can {

ControllerPort::ControllerPort(const Layout& layout, control::Time step) : layout_(layout), schedule_(layout, step), gate_(layout, kToController) {}

void ControllerPort::accept(const Frame& frame) {
    const Payload payload(frame.data);
    const FrameGate::Result verdict = gate_.check(frame, payload);
    if (!verdict.role) return;
    const Role role = *verdict.role;
    if (!verdict.ok) {
        count_rejected(role);
    } else if (decode(role, payload, frame.received)) {
        gate_.count_accepted(role);
    } else {
        gate_.count_wrong_value(role);
        count_rejected(role);
    }
}

bool ControllerPort::decode(Role role, const Payload& payload, control::Time received) {
    switch (role) {
        case Role::wheel:
            wheel_.apply(layout_.wheel, read_raw(layout_.wheel, payload), received, sensors_.wheel);
            return true;
        case Role::flywheel:
            flywheel_.apply(layout_.flywheel, read_raw(layout_.flywheel, payload), received, sensors_.flywheel);
            return true;
        case Role::pressure:
            sensors_.pressure.received = received;
            sensors_.pressure.pressure_Pa = static_cast<float>(layout_.pressure_Pa.value(payload.read(layout_.pressure_Pa)));
            return true;
        case Role::maneuver:
            return apply(layout_.maneuver, read_raw(layout_.maneuver, payload), received, sensors_.maneuver);
        case Role::rig_heartbeat:
            sensors_.rig_heartbeat_received = received;
            return true;
        case Role::sync:
            sync_number_ = layout_.sync_counter.bound() ? static_cast<std::uint32_t>(payload.read(layout_.sync_counter)) : 0U;
            return true;
        case Role::emergency_stop:
        default:  // a message let in that nobody reads would be a mistake in kToController: stop
            sensors_.emergency_stop = true;
            return true;
    }
}

void ControllerPort::count_rejected(Role role) {
    switch (role) {
        case Role::wheel:
            ++sensors_.wheel.rejected;
            break;
        case Role::flywheel:
            ++sensors_.flywheel.rejected;
            break;
        case Role::pressure:
            ++sensors_.pressure.rejected;
            break;
        case Role::maneuver:
            ++sensors_.maneuver.rejected;
            break;
        default:
            break;
    }
}

void ControllerPort::note_link(const LinkStatus& status) {
    sensors_.bus_off = !status.up || status.bus_off || status.bus_off_events != bus_off_events_;
    bus_off_events_ = status.bus_off_events;
}

void ControllerPort::clear_one_shots() {
    sensors_.emergency_stop = false;
    sensors_.missed_periods = 0;
    sensors_.command_unsent = false;
}

std::size_t ControllerPort::due_frames(const control::Command& command, std::span<Frame> out) {
    std::size_t count = 0;
    if (schedule_.due(Role::valve, step_index_)) out[count++] = valve_command(command.current_mA);
    if (schedule_.due(Role::status, step_index_)) out[count++] = status(command);
    if (schedule_.due(Role::faults, step_index_)) out[count++] = faults(command.faults);
    if (schedule_.due(Role::road, step_index_)) out[count++] = road(command.road);
    if (schedule_.due(Role::controller_heartbeat, step_index_)) out[count++] = heartbeat();
    ++step_index_;
    return count;
}

Frame ControllerPort::valve_command(float current_mA) {
    const Signal& current = layout_.valve_current_mA;
    Payload payload;
    payload.write(current, current.raw(static_cast<double>(current_mA)));
    return protect(Role::valve, payload);
}

Frame ControllerPort::status(const control::Command& command) {
    const StatusSignals& s = layout_.status;
    Payload payload;
    payload.write(s.state, static_cast<std::int64_t>(command.state));
    payload.write(s.slip, s.slip.raw(static_cast<double>(command.slip)));
    payload.write(s.slip_reference, s.slip_reference.raw(static_cast<double>(command.slip_reference)));
    payload.write(s.speed_mps, s.speed_mps.raw(static_cast<double>(command.speed_mps)));
    return protect(Role::status, payload);
}

Frame ControllerPort::faults(control::FaultSet faults) {
    Payload payload;
    for (std::size_t i = 0; i < layout_.faults.size(); ++i) {
        payload.write(layout_.faults[i], (faults.bits() >> i) & 1U);
    }
    return protect(Role::faults, payload);
}

Frame ControllerPort::road(const control::RoadEstimate& road) {
    const RoadSignals& s = layout_.road;
    Payload payload;
    payload.write(s.peak_slip, s.peak_slip.raw(static_cast<double>(road.peak_slip)));
    payload.write(s.grip_N, s.grip_N.raw(static_cast<double>(road.grip_N)));
    payload.write(s.confidence, s.confidence.raw(static_cast<double>(road.confidence)));
    return protect(Role::road, payload);
}

Frame ControllerPort::heartbeat() {
    return protect(Role::controller_heartbeat, {});
}

Frame ControllerPort::protect(Role role, const Payload& payload) {
    const Message& message = layout_[role];
    Frame frame{.id = message.id, .length = message.length, .data = {}, .received = {}};
    senders_[static_cast<std::size_t>(role)].protect(message.protection, payload, frame);
    return frame;
}

}  // namespace antiskid::can
