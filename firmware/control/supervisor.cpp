#include "firmware/control/supervisor.hpp"

#include "firmware/control/arithmetic.hpp"

namespace antiskid::control {

namespace {
constexpr float kSelfTestPatience_s = 2.0F;  // residual pressure for this long fails the self-test
constexpr float kAtRest_radps = 0.1F;
constexpr float kStopLasts_s = 0.1F;  // after its newest frame: who asks for it repeats it ten times as often
}  // namespace

Supervisor::Supervisor(const SupervisorConfig& config, float period_s)
    : config_(config),
      period_s_(period_s),
      self_test_(config.self_test_s, period_s),
      residual_pressure_(kSelfTestPatience_s, period_s),
      on_wheels_(config.touchdown_timeout_s, period_s) {}

/// A bounce takes the wheel off the ground and stops it: protection starts again, which is no fault.
void Supervisor::watch_touchdown(bool on_wheels, const Estimate& e) {
    const float rim = e.omega_radps * e.radius_m;
    const bool long_enough = on_wheels_.holds(on_wheels);
    const bool turns_along = e.v_mps > config_.drop_out_mps && rim > config_.unlock_share * e.v_mps;
    if (!on_wheels)
        protected_ = true;
    else if (long_enough || rim > config_.spin_up_mps || turns_along)
        protected_ = false;
}

/// A released wheel comes back within J omega / (mu F_z r), once the valve has let go and an edge can show it: if the rim does not turn with the
/// aircraft by then, something else holds it.
bool Supervisor::stays_locked(bool locked, float speed_mps) {
    constexpr float kPaidBackBy = 3.0F;  // good periods that make up for a locked one
    if (!locked) {
        if (locked_s_ > 0.0F) locked_s_ = larger(locked_s_ - period_s_ / kPaidBackBy, 0.0F);
        return false;
    }
    locked_s_ += period_s_;
    return (locked_s_ - config_.release_s) * config_.min_spin_up_mps2 > config_.unlock_share * speed_mps;
}

State Supervisor::braking_state(const Sensors& sensors, const Estimate& e) {
    if (!sensors.maneuver.weight_on_wheels || protected_) {
        return sensors.maneuver.weight_on_wheels ? State::touchdown_protection : State::armed;
    }
    if (sensors.maneuver.demand_Pa < config_.demand_threshold_Pa) return State::armed;
    const float rim = e.omega_radps * e.radius_m;
    const bool locked = state_ == State::locked_wheel && e.v_mps >= config_.drop_out_mps;
    if (locked && rim < config_.unlock_share * e.v_mps) return State::locked_wheel;  // whatever law is asked for now
    if (sensors.maneuver.law == Law::open_loop) return State::braking;

    const bool slip_needed = sensors.maneuver.law != Law::deceleration;
    const float drop_out = config_.drop_out_mps + (state_ == State::drop_out ? config_.drop_out_hysteresis_mps : 0.0F);
    if (slip_needed && e.v_mps < drop_out) return State::drop_out;
    if (e.v_mps < config_.drop_out_mps) return State::braking;

    return rim < config_.lock_share * e.v_mps ? State::locked_wheel : State::braking;
}

State Supervisor::next(const Sensors& sensors, const Estimate& e, FaultSet present) {
    const bool arm = sensors.maneuver.arm;
    const bool arms = arm && !arm_before_;
    const bool released = sensors.pressure.pressure_Pa < config_.residual_pressure_Pa;
    switch (state_) {
        case State::self_test: {
            const bool at_rest = e.speeds_known && e.omega_radps < kAtRest_radps;
            if (residual_pressure_.holds(at_rest && present.empty() && !released)) {
                latched_.insert(Fault::self_test_failed);
                return State::safe;
            }
            return self_test_.holds(present.empty() && at_rest && released) ? State::standby : State::self_test;
        }
        case State::standby:
            if (arms) latched_ = FaultSet{};
            return arms ? State::armed : State::standby;
        case State::safe:
            if (stop_periods_left_ > 0) {
                --stop_periods_left_;
                return State::safe;
            }
            return !arm && present.empty() && (released || !latched_.contains(Fault::self_test_failed)) ? State::standby : State::safe;
        default:
            return arm ? braking_state(sensors, e) : State::standby;
    }
}

State Supervisor::update(const Sensors& sensors, const Estimate& e, FaultSet present, Time /*now*/) {
    watch_touchdown(sensors.maneuver.weight_on_wheels, e);
    State wanted = next(sensors, e, present);
    // A slip law does not lock repeatedly, unless its inputs or commands are late. Other laws may.
    if (wanted != State::locked_wheel && !holds_slip(sensors.maneuver.law)) locked_s_ = 0.0F;
    if (stays_locked(wanted == State::locked_wheel, e.v_mps)) present.insert(Fault::lock_persists);
    // Before the self-test has passed nothing may be there yet: a missing input is no fault until then, and there is no
    // permission either. The emergency stop is a fault even then.
    if (present.contains(Fault::emergency_stop) || (wanted != State::self_test && !present.empty())) {
        if (present.contains(Fault::emergency_stop)) stop_periods_left_ = whole_periods(kStopLasts_s, period_s_) - 1U;
        latched_.insert(present);
        wanted = State::safe;
    }
    arm_before_ = sensors.maneuver.received != kNever && sensors.maneuver.arm;
    state_ = wanted;
    return state_;
}

}  // namespace antiskid::control
