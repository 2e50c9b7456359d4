#include "firmware/can/rig_port.hpp"

#include "firmware/can/sensor_decoder.hpp"

namespace antiskid::can {

RigPort::RigPort(const Layout& layout, control::Time step, std::span<const Role> sends)
    : layout_(layout), schedule_(layout, step), gate_(layout, kToRig) {
    for (const Role role : sends) sends_[static_cast<std::size_t>(role)] = layout[role].bound;
}

std::size_t RigPort::due_frames(const RigSample& sample, std::span<Frame> out) {
    std::size_t count = 0;
    if (sample.emergency_stop && sends_[static_cast<std::size_t>(Role::emergency_stop)]) out[count++] = emergency_stop();
    if (due(Role::wheel)) out[count++] = wheel(sample.wheel);
    if (due(Role::flywheel)) out[count++] = flywheel(sample.flywheel);
    if (due(Role::pressure)) out[count++] = pressure(sample.pressure_Pa);
    if (due(Role::maneuver)) out[count++] = maneuver(sample.maneuver);
    if (due(Role::rig_heartbeat)) out[count++] = heartbeat();
    if (due(Role::load_cells)) out[count++] = load_cells(sample.load_cells);
    if (state_is_due(sample.maneuver_state)) {
        last_state_ = sample.maneuver_state;
        out[count++] = maneuver_state(sample.maneuver_state);
    }
    ++step_index_;
    return count;
}

bool RigPort::state_is_due(const ManeuverStateSample& sample) const {
    return sends_[static_cast<std::size_t>(Role::maneuver_state)] && (step_index_ == 0 || schedule_.due(Role::maneuver_state, step_index_) ||
                                                                      sample.phase != last_state_.phase || sample.number != last_state_.number);
}

Frame RigPort::wheel(const SpeedSample& sample) {
    return speed(Role::wheel, layout_.wheel, sample);
}

Frame RigPort::flywheel(const SpeedSample& sample) {
    return speed(Role::flywheel, layout_.flywheel, sample);
}

Frame RigPort::speed(Role role, const SpeedSignals& signals, const SpeedSample& sample) {
    const RawSpeed raw = to_raw(signals, sample);
    Payload payload;
    if (signals.source == control::SpeedSource::edges) {
        payload.write(signals.edge_count, static_cast<std::int64_t>(raw.edge_count));
        payload.write(signals.edge_time, static_cast<std::int64_t>(raw.edge_time));
    } else {
        payload.write(signals.speed_radps, raw.speed);
    }
    return protect(role, payload);
}

Frame RigPort::pressure(float pressure_Pa) {
    Payload payload;
    payload.write(layout_.pressure_Pa, layout_.pressure_Pa.raw(static_cast<double>(pressure_Pa)));
    return protect(Role::pressure, payload);
}

Frame RigPort::maneuver(const ManeuverSample& sample) {
    const ManeuverSignals& m = layout_.maneuver;
    const RawManeuver raw = to_raw(m, sample);
    Payload payload;
    payload.write(m.law, raw.law);
    payload.write(m.arm, raw.arm);
    payload.write(m.weight_on_wheels, raw.weight_on_wheels);
    payload.write(m.demand_Pa, raw.demand);
    payload.write(m.slip_reference, raw.slip_reference);
    payload.write(m.deceleration_mps2, raw.deceleration);
    payload.write(m.current_mA, raw.current);
    return protect(Role::maneuver, payload);
}

Frame RigPort::heartbeat() {
    return protect(Role::rig_heartbeat, {});
}

Frame RigPort::emergency_stop() {
    return protect(Role::emergency_stop, {});
}

Frame RigPort::load_cells(const LoadCellSample& sample) {
    const LoadCellSignals& cells = layout_.load_cells;
    Payload payload;
    payload.write(cells.vertical_N, cells.vertical_N.raw(static_cast<double>(sample.vertical_N)));
    payload.write(cells.longitudinal_N, cells.longitudinal_N.raw(static_cast<double>(sample.longitudinal_N)));
    payload.write(cells.brake_torque_Nm, cells.brake_torque_Nm.raw(static_cast<double>(sample.brake_torque_Nm)));
    payload.write(cells.age_ns, cells.age_ns.raw(static_cast<double>(sample.age.count())));
    return protect(Role::load_cells, payload);
}

Frame RigPort::maneuver_state(const ManeuverStateSample& sample) {
    const ManeuverStateSignals& state = layout_.maneuver_state;
    Payload payload;
    payload.write(state.phase, sample.phase);
    payload.write(state.number, sample.number);
    payload.write(state.brake_temperature_C, state.brake_temperature_C.raw(static_cast<double>(sample.brake_temperature_C)));
    return protect(Role::maneuver_state, payload);
}

Frame RigPort::sync(std::uint32_t number) {
    Payload payload;
    if (layout_.sync_counter.bound()) payload.write(layout_.sync_counter, number);
    return protect(Role::sync, payload);
}

void RigPort::accept(const Frame& frame) {
    const Payload payload(frame.data);
    const FrameGate::Result verdict = gate_.check(frame, payload);
    if (!verdict.role || !verdict.ok) return;
    if (apply(layout_, *verdict.role, payload, frame.received, view_)) {
        gate_.count_accepted(*verdict.role);
    } else {
        gate_.count_wrong_value(*verdict.role);
    }
}

Frame RigPort::protect(Role role, const Payload& payload) {
    const Message& message = layout_[role];
    Frame frame{.id = message.id, .length = message.length, .data = {}, .received = {}};
    senders_[static_cast<std::size_t>(role)].protect(message.protection, payload, frame);
    return frame;
}

}  // namespace antiskid::can
