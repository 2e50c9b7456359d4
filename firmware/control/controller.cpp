#include "firmware/control/controller.hpp"

#include "firmware/control/arithmetic.hpp"

namespace antiskid::control {

Controller::Controller(const Config& config)
    : valve_(config.valve),
      pass_through_step_Pa_(config.supervisor.pass_through_rate_Paps * config.period_s),
      estimator_(config),
      monitor_(config),
      supervisor_(config.supervisor, config.period_s),
      slip_law_(config.slip, config.period_s),
      peak_seeker_(config.peak, config.wheel.inertia_kgm2, config.period_s),
      deceleration_law_(config.deceleration, config.slip, config.period_s),
      threshold_law_(config.threshold, config.period_s),
      pressure_bias_law_(config.pressure_bias, config.period_s),
      takeover_Pa_(config.valve.full_pressure_Pa),
      safe_Pa_(valve_pressure_Pa(config.valve, config.valve.safe_current_mA)),
      commanded_Pa_(safe_Pa_),
      held_Pa_(safe_Pa_) {}

void Controller::start_law(Law law, const Estimate& estimate, State before) {
    const bool resumes = before == State::locked_wheel && law == law_;
    law_ = law;
    slip_law_.start(estimate);
    peak_seeker_.start(before == State::locked_wheel);
    deceleration_law_.start(estimate);
    threshold_law_.start(estimate);
    if (resumes)
        pressure_bias_law_.resume(estimate);
    else
        pressure_bias_law_.start(estimate);
}

float Controller::braking_pressure_Pa(const ManeuverInput& maneuver, const Estimate& estimate, State before) {
    // Every return from another state starts the law at the present slip and pressure. A law that takes over from another one starts from
    // the pressure that was asked last and may raise it no faster than a demand that passes through: bumpless, and free to release.
    const bool takes_over = before == State::braking && maneuver.law != law_;
    if (before != State::braking || takes_over) start_law(maneuver.law, estimate, before);
    if (before != State::braking) takeover_Pa_ = valve_.full_pressure_Pa;
    if (takes_over) takeover_Pa_ = requested_Pa_;
    takeover_Pa_ = smaller(takeover_Pa_ + pass_through_step_Pa_, valve_.full_pressure_Pa);
    const float ceiling_Pa = smaller(maneuver.demand_Pa, takeover_Pa_);
    switch (maneuver.law) {
        case Law::wheel_slip:
            return slip_law_.pressure_Pa(estimate, maneuver.slip_reference, ceiling_Pa);
        case Law::deceleration:
            return deceleration_law_.pressure_Pa(estimate, maneuver.deceleration_mps2, ceiling_Pa);
        case Law::open_loop:
            return limited(valve_pressure_Pa(valve_, maneuver.current_mA), 0.0F, ceiling_Pa);
        case Law::peak_slip:
            return slip_law_.follow_Pa(estimate, peak_seeker_.reference(estimate), ceiling_Pa);
        case Law::threshold:
            return threshold_law_.pressure_Pa(estimate, ceiling_Pa);
        default:  // pressure_bias: Monitor lets no law through that does not exist
            return pressure_bias_law_.pressure_Pa(estimate, ceiling_Pa);
    }
}

/// Below drop-out the demand passes through, approached from the present pressure at a limited rate.
float Controller::pass_through_Pa(float ceiling_Pa, const Estimate& estimate, State before) {
    if (before != State::drop_out) passed_Pa_ = estimate.pressure.pressure_Pa;
    passed_Pa_ = limited(towards(passed_Pa_, ceiling_Pa, pass_through_step_Pa_), 0.0F, ceiling_Pa);
    return passed_Pa_;
}

/// The valve's offset is made up for where a pressure is meant: open loop asks for a current, the threshold law switches, and a fielded
/// system does not measure pressure.
float Controller::asked_of_map_Pa(const Command& command, Law law) const {
    const bool means_pressure = holds_slip(law) || law == Law::deceleration;
    const bool by_map = command.state == State::braking && !means_pressure;
    return by_map ? command.pressure_request_Pa : estimator_.compensated_Pa(command.pressure_request_Pa);
}

Command Controller::step(const Sensors& sensors, Time now) {
    if (!sensors.command_unsent) held_Pa_ = commanded_Pa_;
    const Estimate& estimate = estimator_.update(sensors, held_Pa_);
    const State before = supervisor_.state();
    const FaultSet present =
        monitor_.check(sensors, estimator_, {supervisor_.rolling(), before == State::braking, slip_law_.scheduled_reference()}, now);
    const State state = supervisor_.update(sensors, estimate, present, now);
    if (state == State::standby || !sensors.maneuver.weight_on_wheels) {
        slip_law_.forget_runway();
        peak_seeker_.forget_runway();
        pressure_bias_law_.forget_runway();
    }

    Command command;
    command.state = state;
    command.faults = supervisor_.latched();
    command.slip = estimate.slip;
    command.speed_mps = estimate.v_mps;
    command.wheel_speed_radps = estimate.omega_radps;

    // Permission is earned here, every period: in every other state the valve gets the safe current.
    const bool permitted = state == State::braking || state == State::drop_out;
    if (permitted) {
        const float ceiling_Pa = smaller(sensors.maneuver.demand_Pa, valve_.full_pressure_Pa);
        command.pressure_request_Pa =
            state == State::braking ? braking_pressure_Pa(sensors.maneuver, estimate, before) : pass_through_Pa(ceiling_Pa, estimate, before);
        if (state == State::braking && holds_slip(sensors.maneuver.law)) command.slip_reference = slip_law_.reference();
        if (state == State::braking && sensors.maneuver.law == Law::peak_slip) command.road = peak_seeker_.found();
    }
    requested_Pa_ = command.pressure_request_Pa;
    const float asked_Pa = permitted ? asked_of_map_Pa(command, sensors.maneuver.law) : 0.0F;
    command.current_mA = permitted ? valve_current_mA(valve_, asked_Pa) : valve_.safe_current_mA;
    const bool above_min = permitted && asked_Pa > valve_.pressure_Pa[0];
    commanded_Pa_ = above_min ? smaller(asked_Pa, valve_.pressure_Pa[valve_.points - 1U]) : safe_Pa_;
    return command;
}

}  // namespace antiskid::control
