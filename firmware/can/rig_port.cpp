#include "firmware/can/rig_port.hpp"

#include "firmware/can/roles.hpp"
#include "firmware/can/sensor_decoder.hpp"

namespace antiskid::can {

RigPort::RigPort(const Layout& layout, control::Time step)
    : layout_(layout), schedule_(layout, step), gate_(layout, kToRig) {}

std::size_t RigPort::due_frames(const RigSample& sample, std::span<Frame> out) {
    std::size_t count = 0;
    if (sample.emergency_stop) out[count++] = emergency_stop();
    if (schedule_.due(Role::wheel, step_index_)) out[count++] = wheel(sample.wheel);
    if (schedule_.due(Role::flywheel, step_index_)) out[count++] = flywheel(sample.flywheel);
    if (schedule_.due(Role::pressure, step_index_)) out[count++] = pressure(sample.pressure_Pa);
    if (schedule_.due(Role::maneuver, step_index_)) out[count++] = maneuver(sample.maneuver);
    if (schedule_.due(Role::rig_heartbeat, step_index_)) out[count++] = heartbeat();
    if (schedule_.due(Role::load_cells, step_index_)) out[count++] = load_cells(sample.load_cells);
    ++step_index_;
    return count;
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
    payload.write(cells.brake_torque_Nm,
                  cells.brake_torque_Nm.raw(static_cast<double>(sample.brake_torque_Nm)));
    return protect(Role::load_cells, payload);
}

Frame RigPort::sync(std::uint32_t number) {
    Payload payload;
    if (layout_.sync_counter.bound()) payload.write(layout_.sync_counter, number);
    return protect(Role::sync, payload);
}

void RigPort::accept(const Frame& frame) {
    const Payload payload(frame.data);
    const FrameGate::Verdict verdict = gate_.check(frame, payload);
    if (!verdict.role || !verdict.ok) return;
    if (decode(*verdict.role, payload, frame.received)) {
        gate_.count_accepted(*verdict.role);
    } else {
        gate_.count_wrong_value(*verdict.role);
    }
}

bool RigPort::decode(Role role, const Payload& payload, control::Time received) {
    const auto value = [&payload](const Signal& signal) {
        return static_cast<float>(signal.value(payload.read(signal)));
    };
    switch (role) {
        case Role::valve:
            view_.command_received = received;
            view_.current_mA = value(layout_.valve_current_mA);
            return true;
        case Role::status: {
            const std::int64_t state = payload.read(layout_.status.state);
            if (state < 0 || state >= control::kStateCount) return false;
            view_.status_received = received;
            view_.state = static_cast<control::State>(state);
            view_.slip = value(layout_.status.slip);
            view_.slip_reference = value(layout_.status.slip_reference);
            view_.speed_mps = value(layout_.status.speed_mps);
            return true;
        }
        case Role::faults: {
            std::uint32_t bits = 0;
            for (std::size_t i = 0; i < layout_.faults.size(); ++i) {
                if (payload.read(layout_.faults[i]) != 0) bits |= 1U << i;
            }
            view_.faults_received = received;
            view_.faults = control::FaultSet::from_bits(bits);
            return true;
        }
        case Role::controller_heartbeat:
            view_.heartbeat_received = received;
            return true;
        default:
            return false;
    }
}

Frame RigPort::protect(Role role, const Payload& payload) {
    const Message& message = layout_[role];
    Frame frame{.id = message.id, .length = message.length, .data = {}, .received = {}};
    senders_[static_cast<std::size_t>(role)].protect(message.protection, payload, frame);
    return frame;
}

}  // namespace antiskid::can
