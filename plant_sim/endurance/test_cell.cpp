#include "plant_sim/endurance/test_cell.hpp"

#include <algorithm>
#include <cmath>

#include "rig_bridge/scenario/meter_parameters.hpp"

namespace endurance {

using antiskid::control::State;
using antiskid::control::Time;
using rig::Measured;
using sequencer::Phase;

namespace {

Time period_of(const antiskid::control::Config& controller) {
    return Time(std::llround(static_cast<double>(controller.period_s) * 1e6) * 1000);
}

double seconds(Time t) {
    return static_cast<double>(t.count()) * 1e-9;
}

plc::ServedRigOptions with_period(plc::ServedRigOptions options, Time period) {
    options.period_s = seconds(period);
    return options;
}

antiskid::control::Law law(sequencer::BrakeLaw law) {
    switch (law) {
        case sequencer::BrakeLaw::slip:
            return antiskid::control::Law::wheel_slip;
        case sequencer::BrakeLaw::deceleration:
            return antiskid::control::Law::deceleration;
        case sequencer::BrakeLaw::open_loop:
            return antiskid::control::Law::open_loop;
        case sequencer::BrakeLaw::threshold:
            return antiskid::control::Law::threshold;
        case sequencer::BrakeLaw::peak_slip:
            return antiskid::control::Law::peak_slip;
        case sequencer::BrakeLaw::pressure_bias:
            return antiskid::control::Law::pressure_bias;
    }
    return antiskid::control::Law::wheel_slip;
}

antiskid::can::ManeuverSample maneuver(const sequencer::Outputs& out) {
    return {.law = law(out.law),
            .arm = out.arm,
            .weight_on_wheels = out.weight_on_wheels,
            .demand_Pa = static_cast<float>(out.demand_Pa),
            .slip_reference = static_cast<float>(out.slip_reference),
            .deceleration_mps2 = static_cast<float>(out.deceleration_mps2),
            .current_mA = static_cast<float>(out.current_mA)};
}

rig::ShaftSample shaft(const antiskid::can::SpeedSample& sample) {
    return {.edges = true,
            .edge_count = sample.edge_count,
            .edge_time = sample.edge_time,
            .speed_radps = static_cast<double>(sample.speed_radps)};
}

antiskid::can::LoadCellSample load_cells(const rig::MeasuredValues& m) {
    return {.vertical_N = static_cast<float>(rig::at(m, Measured::vertical_load_N)),
            .longitudinal_N = static_cast<float>(rig::at(m, Measured::longitudinal_force_N)),
            .brake_torque_Nm = static_cast<float>(rig::at(m, Measured::brake_torque_Nm))};
}

antiskid::can::ManeuverStateSample maneuver_state(Phase phase, const rig::MeasuredValues& m) {
    return {.phase = static_cast<std::uint8_t>(phase),
            .number = 1,
            .brake_temperature_C = static_cast<float>(rig::at(m, Measured::brake_temperature_C))};
}

/// The meter needs some 50 ms before brake-on and nothing after the brake.
bool metered(Phase phase) {
    return phase == Phase::settling || phase == Phase::braking || phase == Phase::standstill ||
           phase == Phase::retract || phase == Phase::aborting;
}

}  // namespace

TestCell::TestCell(const rig::Scenario& scenario, const antiskid::control::Config& controller,
                   const antiskid::can::Layout& layout, plc::ServedRigOptions options, std::uint64_t seed)
    : scenario_(scenario),
      layout_(layout),
      period_(period_of(controller)),
      periods_per_step_(std::max<std::int64_t>(1, std::llround(kSequencer_s / seconds(period_)))),
      rig_(scenario.rig, with_period(std::move(options), period_), seed),
      controller_(controller),
      link_(layout, period_),
      wheel_(scenario.rig.rig.wheel_encoder.teeth),
      flywheel_(scenario.rig.rig.flywheel_encoder.teeth) {}

sequencer::Inputs TestCell::look() const {
    sequencer::Inputs in = plc_.read(rig_.measured(), rig_.time_s());
    in.bus_up = true;
    in.sensors_fresh = true;
    in.rim_mps = flywheel_.radps() * scenario_.rig.rig.flywheel_radius_m;
    in.wheel_radps = wheel_.radps();
    in.wheel_rim_mps = in.wheel_radps * scenario_.rolling_radius_m(in.load_N);
    in.pressure_Pa = static_cast<double>(rig_.sample().pressure_Pa);
    in.controller_fresh = true;
    in.controller_standby = command_.state == State::standby;
    in.controller_safe = command_.state == State::safe;
    in.controller_armed = command_.state != State::self_test && !in.controller_standby && !in.controller_safe;
    return in;
}

void TestCell::measure(Phase phase, const antiskid::can::RigSample& sample, rig::Meter& meter) const {
    const rig::MeasuredValues& m = rig_.measured();
    meter.feed(rig::as_on_bus(layout_, {.time_s = rig_.time_s(),
                                        .phase = static_cast<std::uint8_t>(phase),
                                        .wheel = shaft(sample.wheel),
                                        .flywheel = shaft(sample.flywheel),
                                        .pressure_Pa = static_cast<double>(sample.pressure_Pa),
                                        .vertical_N = rig::at(m, Measured::vertical_load_N),
                                        .longitudinal_N = rig::at(m, Measured::longitudinal_force_N),
                                        .brake_torque_Nm = rig::at(m, Measured::brake_torque_Nm),
                                        .brake_temperature_C = rig::at(m, Measured::brake_temperature_C)}));
}

void TestCell::period(const sequencer::Outputs& outputs, rig::Meter& meter, const PeriodObserver& observe) {
    antiskid::can::RigSample sample = rig_.sample();
    sample.maneuver = maneuver(outputs);
    sample.emergency_stop = outputs.emergency_stop;
    if (metered(outputs.phase)) measure(outputs.phase, sample, meter);
    const antiskid::control::Sensors& sensed = link_.sense(sample, now_);
    wheel_.update(sensed.wheel, now_);
    flywheel_.update(sensed.flywheel, now_);
    command_ = controller_.step(sensed, now_);
    faults_.insert(command_.faults);
    const auto current_mA = static_cast<double>(link_.current_mA(command_));
    if (observe) {
        sample.load_cells = load_cells(rig_.measured());
        sample.maneuver_state = maneuver_state(outputs.phase, rig_.measured());
        observe({.time_s = rig_.time_s(), .sample = sample, .command = command_, .current_mA = current_mA});
    }
    rig_.advance(current_mA);
    now_ += period_;
}

void TestCell::cool(const sequencer::Plan& plan) {
    const double wait_s = rig_.cooling_time_s(plan.cool_to_C);
    if (std::isfinite(wait_s)) rig_.pass_idle(wait_s);
}

void TestCell::await_cold_brake(const sequencer::Plan& plan) {
    const double cold_C = std::min(plan.cool_to_C, plan.brake_on_limit_C);
    rig::Meter none(rig::meter_parameters(scenario_.rig, seconds(period_)));
    while (rig_.brake_temperature_C() > cold_C && std::isfinite(rig_.cooling_time_s(cold_C))) {
        rig_.command(plc_.command({}, false, rig_.time_s()));
        if (rig_.idle()) rig_.pass_idle(rig_.cooling_time_s(cold_C) + seconds(period_));
        for (std::int64_t i = 0; i < periods_per_step_; ++i) period({}, none, {});
    }
}

Outcome TestCell::run(const sequencer::Plan& plan, const PeriodObserver& observe) {
    sequencer::Sequencer sequencer(plan);
    rig::Meter meter(rig::meter_parameters(scenario_.rig, seconds(period_)));
    await_cold_brake(plan);
    faults_ = {};
    while (!sequencer.over()) {
        const sequencer::Inputs seen = look();
        const sequencer::Outputs outputs = sequencer.step(seen, rig_.time_s());
        const bool reset =
            reset_.step(outputs.phase == Phase::idle && !seen.plc_ready && seen.emergency_stop_clear &&
                            seen.guard_closed && seen.hydraulics_ready && seen.drive_healthy,
                        rig_.time_s());
        rig_.command(plc_.command(outputs, reset, rig_.time_s()));
        if (outputs.phase == Phase::cool_down && rig_.idle()) cool(plan);
        for (std::int64_t i = 0; i < periods_per_step_; ++i) period(outputs, meter, observe);
    }
    return {.phase = sequencer.phase(),
            .abort = sequencer.abort(),
            .figures = meter.figures(),
            .faults = faults_};
}

}  // namespace endurance
