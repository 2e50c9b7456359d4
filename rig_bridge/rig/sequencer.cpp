#include "rig_bridge/rig/sequencer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rig_bridge/rig/check_plan.hpp"

namespace rig {

namespace {

bool plc_heard(const Inputs& in) {
    return in.plc_fresh && std::isfinite(in.flywheel_mps) && std::isfinite(in.sledge_m) && std::isfinite(in.load_N) &&
           std::isfinite(in.brake_temperature_C);
}

bool sensors_heard(const Inputs& in) {
    return in.sensors_fresh && std::isfinite(in.rim_mps) && std::isfinite(in.wheel_radps) && std::isfinite(in.wheel_rim_mps) &&
           std::isfinite(in.pressure_Pa);
}

/// Whether the phase needs the controller's permission.
bool armed_phase(Phase phase) {
    return phase == Phase::touchdown || phase == Phase::settling || phase == Phase::braking;
}

bool before_brake_on(Phase phase) {
    return phase == Phase::idle || phase == Phase::spin_up || phase == Phase::touchdown || phase == Phase::settling;
}

}  // namespace

double top_speed_mps(const Plan& plan) {
    return plan.speed_mps * (1.0 + plan.wheel_share) + plan.coasting_mps + plan.speed_band_mps;
}

Sequencer::Sequencer(Plan plan) : plan_(std::move(plan)) {
    check(plan_);
}

Abort Sequencer::cause(const Inputs& in) const {
    if (!plc_heard(in)) return Abort::plc_silent;
    if (!in.emergency_stop_clear) return Abort::emergency_stop;
    if (!in.guard_closed) return Abort::guard_open;
    if (!in.hydraulics_ready) return Abort::hydraulics_lost;
    if (!in.drive_healthy) return Abort::drive_fault;
    if (!in.plc_ready) return Abort::plc_tripped;
    if (in.foreign_command) return Abort::foreign_command;
    if (in.commit_rejected || in.commit_late || (phase_ == Phase::spin_up && !sledge_back(in))) return Abort::command_rejected;
    if (in.flywheel_mps > top_speed_mps(plan_)) return Abort::overspeed;
    if (!in.bus_up) return Abort::bus_lost;
    if (!in.bus_read) return Abort::bus_unread;
    if (in.two_senders) return Abort::two_senders;
    if (!in.controller_fresh) return Abort::controller_silent;
    if (!sensors_heard(in)) return Abort::sensors_lost;
    if (disagreed_s_ > plan_.mismatch_s) return Abort::speed_mismatch;
    const bool holds = phase_ == Phase::standstill && elapsed_s() < plan_.hold_s;
    if (in.controller_safe || ((armed_phase(phase_) || holds) && !in.controller_armed)) return Abort::controller_fault;
    if (phase_ == Phase::braking && (!in.wheel_on_rim || !load_in_band(in))) return Abort::load_lost;
    if (before_brake_on(phase_) && in.brake_temperature_C > plan_.brake_on_limit_C) return Abort::brake_hot;
    return Abort::none;
}

bool Sequencer::sledge_back(const Inputs& in) const {
    return in.sledge_m <= plan_.sledge_back_m && !in.wheel_on_rim;
}

bool Sequencer::load_in_band(const Inputs& in) const {
    const double v = in.flywheel_mps;
    const double law_N = plan_.load_base_N - plan_.load_lift_Ns2pm2 * v * v;
    return std::abs(in.load_N - law_N) <= plan_.load_band * std::abs(law_N);
}

bool Sequencer::ready(const Inputs& in) const {
    return in.controller_standby && sledge_back(in) && in.pressure_Pa < plan_.pressure_gone_Pa &&
           in.flywheel_mps <= set_point_mps(in) + plan_.speed_tolerance_mps;
}

/// Compares only speeds with new readings: an encoder without frames keeps its last one. An old reading of the PLC may differ by as
/// much as a tyre can have changed the speed since.
void Sequencer::compare_speeds(const Inputs& in, double passed_s) {
    constexpr double kSilent_s = 0.03;
    constexpr double kHardest_mps2 = 12.0;  // the friction of dry asphalt, 1.17 g
    if (!plc_heard(in) || !sensors_heard(in) || in.rim_age_s > kSilent_s) return;
    const double unseen_mps = in.rim_mps < plan_.encoder_blind_mps ? plan_.encoder_blind_mps : 0.0;
    const double band_mps = plan_.speed_band_mps + unseen_mps + kHardest_mps2 * in.flywheel_age_s;
    disagreed_s_ = std::abs(in.flywheel_mps - in.rim_mps) <= band_mps ? 0.0 : disagreed_s_ + passed_s;
}

double Sequencer::set_point_mps(const Inputs& in) const {
    const double lacks_mps = plan_.speed_mps - plan_.rolling_radius_m * in.wheel_radps;
    return plan_.speed_mps + plan_.wheel_share * lacks_mps + plan_.coasting_mps;
}

bool Sequencer::at_speed(const Inputs& in) {
    const double set_mps = set_point_mps(in);
    // Each change is a separate command to the PLC.
    if (std::abs(set_mps - set_mps_) > 0.5 * plan_.speed_tolerance_mps) set_mps_ = set_mps;
    const bool there = std::abs(in.flywheel_mps - set_mps) <= plan_.speed_tolerance_mps;
    if (there && (arming_ || in.controller_standby)) arming_ = true;
    return there && arming_ && in.controller_armed;
}

bool Sequencer::settled(const Inputs& in) {
    const bool rolls = in.wheel_on_rim && std::abs(in.flywheel_mps - in.wheel_rim_mps) <= plan_.settle_slip * in.flywheel_mps;
    if (!rolls || !load_in_band(in)) unsettled_s_ = now_s_;
    return elapsed_s() >= plan_.settle_s && now_s_ - unsettled_s_ >= plan_.settle_hold_s &&
           in.flywheel_mps <= plan_.speed_mps + plan_.speed_tolerance_mps && in.flywheel_mps >= plan_.speed_mps - plan_.speed_band_mps;
}

bool Sequencer::released(const Inputs& in) {
    return elapsed_s() >= plan_.hold_s && in.pressure_Pa < plan_.pressure_gone_Pa;
}

/// Whether the present phase has reached its end.
bool Sequencer::done(const Inputs& in) {
    switch (phase_) {
        case Phase::idle:
            set_mps_ = set_point_mps(in);
            return ready(in);
        case Phase::spin_up:
            return at_speed(in);
        case Phase::touchdown:
            return in.wheel_on_rim;
        case Phase::settling:
            return settled(in);
        case Phase::braking:
            return in.flywheel_mps < plan_.standstill_mps;
        case Phase::standstill:
            return released(in);
        case Phase::retract:
            return sledge_back(in);
        case Phase::cool_down:
            return in.brake_temperature_C <= plan_.cool_to_C;
        case Phase::aborting:
            safe_end_ = plc_heard(in) && sledge_back(in) && sensors_heard(in) && in.pressure_Pa < plan_.pressure_gone_Pa;
            return safe_end_;
        case Phase::finished:
        case Phase::aborted:
            return false;
    }
    return false;
}

double Sequencer::limit_s() const {
    switch (phase_) {
        case Phase::idle:
            return plan_.idle_limit_s;
        case Phase::spin_up:
            return plan_.spin_up_limit_s;
        case Phase::touchdown:
            return plan_.touchdown_limit_s;
        case Phase::settling:
            return plan_.settling_limit_s;
        case Phase::braking:
            return plan_.braking_limit_s;
        case Phase::standstill:
            return plan_.standstill_limit_s;
        case Phase::retract:
            return plan_.retract_limit_s;
        case Phase::cool_down:
            return plan_.cool_down_limit_s;
        case Phase::aborting:
            return plan_.abort_limit_s;
        case Phase::finished:
        case Phase::aborted:
            break;
    }
    return INFINITY;
}

void Sequencer::enter(Phase phase) {
    phase_ = phase;
    entered_s_ = now_s_;
    unsettled_s_ = now_s_;
    if (phase == Phase::braking) brake_on_s_ = now_s_;
}

void Sequencer::leave_for_abort(Abort cause) {
    abort_ = cause;
    enter(Phase::aborting);
}

Outputs Sequencer::step(const Inputs& in, double now_s) {
    if (!started_) {
        started_ = true;
        now_s_ = now_s;
        enter(Phase::idle);
        return outputs(in);
    }
    const double passed_s = std::max(now_s - now_s_, 0.0);
    now_s_ = std::max(now_s, now_s_);
    // The first status frame of a second controller, or the first rejected one, comes before its sender can be distinguished.
    if (in.two_senders && (abort_ == Abort::controller_silent || abort_ == Abort::controller_fault)) abort_ = Abort::two_senders;
    if (over()) return outputs(in);
    compare_speeds(in, passed_s);

    const bool late = elapsed_s() > limit_s();
    if (phase_ == Phase::aborting) {
        if (done(in) || late) enter(Phase::aborted);
        return outputs(in);
    }
    const Abort now = cause(in);
    const bool waits = phase_ == Phase::idle && !late;
    if (now != Abort::none && !waits)
        leave_for_abort(now);
    else if (in.abort_requested)
        leave_for_abort(Abort::requested);
    else if (late)
        leave_for_abort(Abort::phase_timeout);
    else if (now == Abort::none && done(in))
        enter(static_cast<Phase>(static_cast<std::uint8_t>(phase_) + 1U));
    return outputs(in);
}

double Sequencer::current_mA(double since_brake_on_s) const {
    const auto& points = plan_.current;
    const auto next = std::upper_bound(points.begin(), points.end(), since_brake_on_s, [](double t, const CurrentPoint& p) { return t < p.time_s; });
    if (next == points.begin()) return points.front().current_mA;
    if (next == points.end()) return points.back().current_mA;
    const CurrentPoint& a = *(next - 1);
    return a.current_mA + (next->current_mA - a.current_mA) * (since_brake_on_s - a.time_s) / (next->time_s - a.time_s);
}

void Sequencer::brake(Outputs& out) const {
    out.demand_Pa = plan_.demand_Pa;
    if (plan_.law == BrakeLaw::open_loop) out.current_mA = current_mA(now_s_ - brake_on_s_);
}

Outputs Sequencer::outputs(const Inputs& in) const {
    Outputs out;
    out.phase = phase_;
    out.abort = abort_;
    out.law = plan_.law;
    out.slip_reference = plan_.slip_reference;
    out.deceleration_mps2 = plan_.deceleration_mps2;
    // A cause that appears during the abort may be worse than the first one.
    out.emergency_stop = phase_ == Phase::aborting && (stops_controller(abort_) || stops_controller(cause(in)));
    if (phase_ == Phase::spin_up) {
        out.drive_enable = true;
        out.flywheel_set_mps = set_mps_;
        out.arm = arming_;
    }
    if (armed_phase(phase_) || phase_ == Phase::standstill) {
        out.arm = true;
        out.sledge_advance = true;
        out.load_enable = true;
        out.load_base_N = plan_.load_base_N;
        out.load_lift_Ns2pm2 = plan_.load_lift_Ns2pm2;
        out.weight_on_wheels = in.wheel_on_rim;
    }
    if (phase_ == Phase::braking || (phase_ == Phase::standstill && elapsed_s() < plan_.hold_s)) brake(out);
    return out;
}

}  // namespace rig
