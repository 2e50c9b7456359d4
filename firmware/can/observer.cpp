#include "firmware/can/observer.hpp"

#include "firmware/can/roles.hpp"
#include "firmware/can/value_names.hpp"

namespace antiskid::can {

namespace {

float read(const Payload& payload, const Signal& signal) {
    return static_cast<float>(signal.value(payload.read(signal)));
}

}  // namespace

Observer::Observer(const Layout& layout) : layout_(layout), gate_(layout, kEveryRole) {}

std::optional<Role> Observer::accept(const Frame& frame) {
    const Payload payload(frame.data);
    const FrameGate::Result verdict = gate_.check(frame, payload);
    if (!verdict.role || !verdict.ok) return std::nullopt;
    if (!decode(*verdict.role, payload, frame.received)) {
        gate_.count_wrong_value(*verdict.role);
        return std::nullopt;
    }
    gate_.count_accepted(*verdict.role);
    return verdict.role;
}

bool Observer::decode(Role role, const Payload& payload, control::Time received) {
    switch (role) {
        case Role::wheel:
            wheel_.apply(layout_.wheel, read_raw(layout_.wheel, payload), received, view_.wheel);
            return true;
        case Role::flywheel:
            flywheel_.apply(layout_.flywheel, read_raw(layout_.flywheel, payload), received, view_.flywheel);
            return true;
        case Role::pressure:
            view_.pressure.received = received;
            view_.pressure.pressure_Pa = read(payload, layout_.pressure_Pa);
            return true;
        case Role::maneuver:
            return apply(layout_.maneuver, read_raw(layout_.maneuver, payload), received, view_.maneuver);
        case Role::rig_heartbeat:
            view_.rig_heartbeat_received = received;
            return true;
        case Role::emergency_stop:
            view_.emergency_stop_received = received;
            return true;
        case Role::sync:
            view_.sync_received = received;
            if (layout_.sync_counter.bound()) view_.sync_number = static_cast<std::uint32_t>(payload.read(layout_.sync_counter));
            return true;
        case Role::load_cells:
            view_.load_cells_received = received;
            view_.load_cells = {
                .vertical_N = read(payload, layout_.load_cells.vertical_N),
                .longitudinal_N = read(payload, layout_.load_cells.longitudinal_N),
                .brake_torque_Nm = read(payload, layout_.load_cells.brake_torque_Nm),
                .age = control::Time{static_cast<std::int64_t>(layout_.load_cells.age_ns.value(payload.read(layout_.load_cells.age_ns)))}};
            return true;
        case Role::maneuver_state: {
            const std::int64_t phase = payload.read(layout_.maneuver_state.phase);
            if (phase >= static_cast<std::int64_t>(kPhaseNames.size())) return false;
            view_.maneuver_state_received = received;
            view_.maneuver_state = {.phase = static_cast<std::uint8_t>(phase),
                                    .number = static_cast<std::uint32_t>(payload.read(layout_.maneuver_state.number)),
                                    .brake_temperature_C = read(payload, layout_.maneuver_state.brake_temperature_C)};
            return true;
        }
        default:
            return apply(layout_, role, payload, received, view_.controller);
    }
}

}  // namespace antiskid::can
