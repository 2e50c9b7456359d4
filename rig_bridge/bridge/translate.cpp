#include "rig_bridge/bridge/translate.hpp"

#include <algorithm>
#include <cmath>

namespace rig::bridge {

using antiskid::can::RigSample;
using antiskid::can::Time;
using antiskid::control::kNever;
using antiskid::control::State;
using rig::Inputs;
using rig::Outputs;

namespace {

bool interlock(const modbus::Snapshot& plc, Interlock which) {
    const auto bits = static_cast<unsigned>(plc.value(Measured::interlocks));
    return (bits >> static_cast<unsigned>(which) & 1U) != 0U;
}

double age_s(Time received, Time valid_at) {
    return std::chrono::duration<double>(valid_at - received).count();
}

/// Received at most `limit_s` before `valid_at`.
bool fresh(Time received, Time valid_at, double limit_s) {
    return received != kNever && age_s(received, valid_at) <= limit_s;
}

float brake_temperature_C(const MeasuredValues& plc) {
    const double value = at(plc, Measured::brake_temperature_C);
    return std::isfinite(value) ? static_cast<float>(value) : 0.0F;
}

}  // namespace

bool plc_fresh(const modbus::Snapshot& plc, const Freshness& limits) {
    if (plc.link == modbus::LinkState::map_rejected || !(plc.plc_watchdog_age_s <= limits.watchdog_s)) return false;
    for (std::size_t i = 0; i < kMeasuredCount; ++i) {
        if (!plc.fresh(static_cast<Measured>(i), limits.registers_s)) return false;
    }
    return true;
}

bool interlocks_good(const modbus::Snapshot& plc, const Freshness& limits) {
    if (!plc_fresh(plc, limits)) return false;
    for (std::size_t i = 0; i < kInterlockCount; ++i) {
        if (!interlock(plc, static_cast<Interlock>(i))) return false;
    }
    return true;
}

Inputs sequencer_inputs(const modbus::Snapshot& plc, const BusNow& bus, Time now, const Freshness& limits) {
    Inputs in;
    in.plc_fresh = plc_fresh(plc, limits);
    if (in.plc_fresh) {
        in.plc_ready = plc.value(Measured::plc_state) == static_cast<double>(PlcState::ready);
        in.emergency_stop_clear = interlock(plc, Interlock::emergency_stop_clear);
        in.guard_closed = interlock(plc, Interlock::guard_closed);
        in.hydraulics_ready = interlock(plc, Interlock::hydraulics_ready);
        in.drive_healthy = interlock(plc, Interlock::drive_healthy);
        in.flywheel_mps = plc.value(Measured::flywheel_speed_mps);
        in.flywheel_age_s = plc.age_s[static_cast<std::size_t>(Measured::flywheel_speed_mps)];
        in.sledge_m = plc.value(Measured::sledge_position_m);
        in.wheel_on_rim = plc.value(Measured::wheel_on_rim) == 1.0;
        in.load_N = plc.value(Measured::vertical_load_N);
        in.brake_temperature_C = plc.value(Measured::brake_temperature_C);
    }
    in.commit_rejected = plc.command == modbus::CommandState::rejected || plc.command == modbus::CommandState::unsendable;
    in.commit_late = plc.pending_s > limits.commit_s;

    in.bus_up = bus.up;
    in.bus_read = fresh(bus.valid_at, now, limits.recorder_s);
    if (!in.bus_read) return in;
    in.two_senders = !bus.two_controllers.empty() || !bus.two_bridges.empty();
    const antiskid::can::BusView& v = bus.view;
    in.sensors_fresh = fresh(v.wheel.received, bus.valid_at, limits.sensors_s) && fresh(v.flywheel.received, bus.valid_at, limits.sensors_s) &&
                       fresh(v.pressure.received, bus.valid_at, limits.sensors_s);
    in.rim_mps = bus.rim_mps;
    if (in.sensors_fresh) in.rim_age_s = age_s(v.flywheel.received, bus.valid_at);
    in.wheel_radps = bus.wheel_radps;
    in.wheel_rim_mps = bus.wheel_rim_mps;
    in.pressure_Pa = static_cast<double>(v.pressure.pressure_Pa);
    in.controller_fresh = fresh(v.controller.status_received, bus.valid_at, limits.controller_s);
    in.controller_standby = v.controller.state == State::standby;
    in.controller_safe = v.controller.state == State::safe;
    in.controller_armed = !in.controller_standby && !in.controller_safe && v.controller.state != State::self_test;
    return in;
}

CommandedValues commands(const Outputs& out, bool reset) {
    CommandedValues values{};
    at(values, Commanded::drive_enable) = out.drive_enable ? 1.0 : 0.0;
    at(values, Commanded::flywheel_speed_mps) = out.flywheel_set_mps;
    at(values, Commanded::sledge_advance) = out.sledge_advance ? 1.0 : 0.0;
    at(values, Commanded::load_enable) = out.load_enable ? 1.0 : 0.0;
    at(values, Commanded::load_base_N) = out.load_base_N;
    at(values, Commanded::load_lift_Ns2pm2) = out.load_lift_Ns2pm2;
    at(values, Commanded::reset) = reset ? 1.0 : 0.0;
    return values;
}

RigSample rig_sample(const Outputs& out, const MeasuredValues& plc, std::int64_t maneuver_number) {
    RigSample sample;
    sample.maneuver.law = static_cast<antiskid::control::Law>(out.law);
    sample.maneuver.arm = out.arm;
    sample.maneuver.weight_on_wheels = out.weight_on_wheels;
    sample.maneuver.demand_Pa = static_cast<float>(out.demand_Pa);
    sample.maneuver.slip_reference = static_cast<float>(out.slip_reference);
    sample.maneuver.deceleration_mps2 = static_cast<float>(out.deceleration_mps2);
    sample.maneuver.current_mA = static_cast<float>(out.current_mA);
    sample.maneuver_state.phase = static_cast<std::uint8_t>(out.phase);
    sample.maneuver_state.number = static_cast<std::uint32_t>(maneuver_number);
    sample.maneuver_state.brake_temperature_C = brake_temperature_C(plc);
    sample.emergency_stop = out.emergency_stop;
    return sample;
}

antiskid::can::LoadCellSample load_cells(const MeasuredValues& plc) {
    return {.vertical_N = static_cast<float>(at(plc, Measured::vertical_load_N)),
            .longitudinal_N = static_cast<float>(at(plc, Measured::longitudinal_force_N)),
            .brake_torque_Nm = static_cast<float>(at(plc, Measured::brake_torque_Nm))};
}

bool load_cells_fresh(const modbus::Snapshot& plc, const Freshness& limits) {
    return plc.plc_watchdog_age_s <= limits.load_cells_s && plc.fresh(Measured::vertical_load_N, limits.load_cells_s) &&
           plc.fresh(Measured::longitudinal_force_N, limits.load_cells_s) && plc.fresh(Measured::brake_torque_Nm, limits.load_cells_s);
}

}  // namespace rig::bridge
