#include "plant_sim/endurance/direct_plc.hpp"

namespace endurance {

using rig::Commanded;
using rig::Measured;

namespace {

/// Everything but watchdog and commit.
rig::CommandedValues registers(const sequencer::Outputs& out, bool reset) {
    rig::CommandedValues c{};
    rig::at(c, Commanded::drive_enable) = out.drive_enable ? 1.0 : 0.0;
    rig::at(c, Commanded::flywheel_speed_mps) = out.flywheel_set_mps;
    rig::at(c, Commanded::sledge_advance) = out.sledge_advance ? 1.0 : 0.0;
    rig::at(c, Commanded::load_enable) = out.load_enable ? 1.0 : 0.0;
    rig::at(c, Commanded::load_base_N) = out.load_base_N;
    rig::at(c, Commanded::load_lift_Ns2pm2) = out.load_lift_Ns2pm2;
    rig::at(c, Commanded::reset) = reset ? 1.0 : 0.0;
    return c;
}

bool good(const rig::MeasuredValues& m, rig::Interlock interlock) {
    const auto bits = static_cast<unsigned>(rig::at(m, Measured::interlocks));
    return (bits >> static_cast<unsigned>(interlock) & 1U) != 0U;
}

}  // namespace

const rig::CommandedValues& DirectPlc::command(const sequencer::Outputs& wanted, bool reset, double now_s) {
    rig::CommandedValues next = registers(wanted, reset);
    rig::at(next, Commanded::bridge_watchdog) = rig::at(commanded_, Commanded::bridge_watchdog);
    rig::at(next, Commanded::commit) = commit_;
    if (next != commanded_ || commit_ == 0) {
        commit_ = commit_ == UINT16_MAX ? std::uint16_t{1} : static_cast<std::uint16_t>(commit_ + 1U);
        committed_s_ = now_s;
    }
    rig::at(next, Commanded::commit) = commit_;
    rig::at(next, Commanded::bridge_watchdog) = ++watchdog_;
    commanded_ = next;
    return commanded_;
}

sequencer::Inputs DirectPlc::read(const rig::MeasuredValues& m, double now_s) const {
    sequencer::Inputs in;
    in.plc_fresh = true;
    in.plc_ready = rig::at(m, Measured::plc_state) == static_cast<double>(rig::PlcState::ready);
    in.commit_refused = commit_ != 0 && rig::at(m, Measured::refused_commit) == commit_;
    in.commit_late = rig::at(m, Measured::applied_commit) != commit_ && now_s - committed_s_ > kConfirm_s;
    in.emergency_stop_clear = good(m, rig::Interlock::emergency_stop_clear);
    in.guard_closed = good(m, rig::Interlock::guard_closed);
    in.hydraulics_ready = good(m, rig::Interlock::hydraulics_ready);
    in.drive_healthy = good(m, rig::Interlock::drive_healthy);
    in.flywheel_mps = rig::at(m, Measured::flywheel_speed_mps);
    in.sledge_m = rig::at(m, Measured::sledge_position_m);
    in.wheel_on_rim = rig::at(m, Measured::wheel_on_rim) == 1.0;
    in.load_N = rig::at(m, Measured::vertical_load_N);
    in.brake_temperature_C = rig::at(m, Measured::brake_temperature_C);
    return in;
}

}  // namespace endurance
