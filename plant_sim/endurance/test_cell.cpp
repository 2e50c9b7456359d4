#include "plant_sim/endurance/test_cell.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/can/names.hpp"
#include "firmware/can/value_names.hpp"
#include "firmware/host/seconds.hpp"
#include "plant_sim/study/loop.hpp"
#include "rig_bridge/rig/meter_parameters.hpp"

namespace endurance {

using antiskid::host::seconds;

using antiskid::control::Time;
using rig::Commanded;
using rig::Measured;
using rig::Phase;

namespace {

plc::ServedRigOptions with_period(plc::ServedRigOptions options, Time period) {
    options.period_s = seconds(period);
    return options;
}

/// The meter needs some 50 ms before brake-on and nothing after the brake.
bool metered(Phase phase) {
    return phase == Phase::settling || phase == Phase::braking || phase == Phase::standstill || phase == Phase::retract || phase == Phase::aborting;
}

}  // namespace

TestCell::TestCell(const rig::Scenario& scenario, const antiskid::control::Config& controller, const antiskid::can::Layout& layout,
                   plc::ServedRigOptions options, std::uint64_t seed)
    : scenario_(scenario),
      layout_(layout),
      period_(study::period_of(controller)),
      periods_per_step_(std::max<std::int64_t>(1, std::llround(kSequencer_s / seconds(period_)))),
      rig_(scenario.rig, with_period(std::move(options), period_), seed),
      controller_(controller),
      link_(layout, period_),
      wheel_(scenario.rig.rig.wheel_encoder.teeth),
      flywheel_(scenario.rig.rig.flywheel_encoder.teeth) {}

rig::Inputs TestCell::sequencer_inputs() const {
    const rig::MeasuredValues& measured = rig_.measured();
    rig::modbus::Snapshot plc;
    plc.values = measured;
    plc.link = rig::modbus::LinkState::connected;
    plc.quality.fill(rig::ValueQuality::good);
    if (commit_ != 0 && rig::at(measured, Measured::rejected_commit) == commit_) plc.command = rig::modbus::CommandState::rejected;
    if (rig::at(measured, Measured::applied_commit) != commit_) plc.pending_s = rig_.time_s() - committed_s_;
    rig::bridge::BusNow bus;
    bus.up = true;
    bus.valid_at = now_;
    for (auto* received : {&bus.view.wheel.received, &bus.view.flywheel.received, &bus.view.pressure.received, &bus.view.controller.status_received})
        *received = now_;
    bus.view.pressure.pressure_Pa = rig_.sample().pressure_Pa;
    bus.view.controller.state = command_.state;
    bus.rim_mps = flywheel_.radps() * scenario_.rig.rig.flywheel_radius_m;
    bus.wheel_radps = wheel_.radps();
    bus.wheel_rim_mps = bus.wheel_radps * scenario_.rolling_radius_m(rig::at(measured, Measured::vertical_load_N));
    constexpr double kConfirm_s = 0.1;
    return rig::bridge::sequencer_inputs(plc, bus, now_, {.commit_s = kConfirm_s});
}

void TestCell::command(const rig::Outputs& outputs, bool reset) {
    rig::CommandedValues next = rig::bridge::commands(outputs, reset);
    rig::at(next, Commanded::bridge_watchdog) = watchdog_;
    rig::at(next, Commanded::commit) = commit_;
    if (next != commanded_ || commit_ == 0) {
        commit_ = commit_ == UINT16_MAX ? std::uint16_t{1} : static_cast<std::uint16_t>(commit_ + 1U);
        committed_s_ = rig_.time_s();
    }
    rig::at(next, Commanded::commit) = commit_;
    rig::at(next, Commanded::bridge_watchdog) = ++watchdog_;
    commanded_ = next;
    rig_.command(commanded_);
}

void TestCell::measure(Phase phase, const antiskid::can::RigSample& sample, rig::record::Meter& meter) const {
    const rig::MeasuredValues& m = rig_.measured();
    meter.feed(rig::record::as_on_bus(layout_, {.time_s = rig_.time_s(),
                                                .phase = static_cast<std::uint8_t>(phase),
                                                .wheel = rig::record::shaft_sample(sample.wheel),
                                                .flywheel = rig::record::shaft_sample(sample.flywheel),
                                                .pressure_Pa = static_cast<double>(sample.pressure_Pa),
                                                .vertical_N = rig::at(m, Measured::vertical_load_N),
                                                .longitudinal_N = rig::at(m, Measured::longitudinal_force_N),
                                                .brake_torque_Nm = rig::at(m, Measured::brake_torque_Nm),
                                                .brake_temperature_C = rig::at(m, Measured::brake_temperature_C)}));
}

void TestCell::period(const rig::Outputs& outputs, rig::record::Meter& meter, const PeriodObserver& observe) {
    antiskid::can::RigSample sample = rig_.sample();
    const antiskid::can::RigSample from_bridge = rig::bridge::rig_sample(outputs, rig_.measured(), 1);
    sample.maneuver = from_bridge.maneuver;
    sample.emergency_stop = from_bridge.emergency_stop;
    if (metered(outputs.phase)) measure(outputs.phase, sample, meter);
    const antiskid::control::Sensors& sensed = link_.sense(sample, now_);
    wheel_.update(sensed.wheel);
    flywheel_.update(sensed.flywheel);
    command_ = controller_.step(sensed, now_);
    faults_.insert(command_.faults);
    const auto current_mA = static_cast<double>(link_.current_mA(command_));
    if (observe) {
        sample.load_cells = rig::bridge::load_cells(rig_.measured());
        sample.maneuver_state = from_bridge.maneuver_state;
        observe({.time_s = rig_.time_s(), .sample = sample, .command = command_, .current_mA = current_mA});
    }
    rig_.advance(current_mA);
    now_ += period_;
}

void TestCell::cool(const rig::Plan& plan) {
    const double wait_s = rig_.cooling_time_s(plan.cool_to_C);
    if (std::isfinite(wait_s)) rig_.pass_idle(wait_s);
}

void TestCell::await_cold_brake(const rig::Plan& plan) {
    const double cold_C = std::min(plan.cool_to_C, plan.brake_on_limit_C);
    rig::record::Meter none(rig::meter_parameters(scenario_.rig, seconds(period_)));
    while (rig_.brake_temperature_C() > cold_C && std::isfinite(rig_.cooling_time_s(cold_C))) {
        command({}, false);
        if (rig_.idle()) rig_.pass_idle(rig_.cooling_time_s(cold_C) + seconds(period_));
        for (std::int64_t i = 0; i < periods_per_step_; ++i) period({}, none, {});
    }
}

Outcome TestCell::run(const rig::Plan& plan, const PeriodObserver& observe) {
    rig::Sequencer sequencer(plan);
    rig::record::Meter meter(rig::meter_parameters(scenario_.rig, seconds(period_)));
    await_cold_brake(plan);
    faults_ = {};
    while (!sequencer.over()) {
        const rig::Inputs inputs = sequencer_inputs();
        const rig::Outputs outputs = sequencer.step(inputs, rig_.time_s());
        const bool reset = reset_.step(outputs.phase == Phase::idle && !inputs.plc_ready && inputs.emergency_stop_clear && inputs.guard_closed &&
                                           inputs.hydraulics_ready && inputs.drive_healthy,
                                       rig_.time_s());
        command(outputs, reset);
        if (outputs.phase == Phase::cool_down && rig_.idle()) cool(plan);
        for (std::int64_t i = 0; i < periods_per_step_; ++i) period(outputs, meter, observe);
    }
    return {.phase = sequencer.phase(), .abort = sequencer.abort(), .figures = meter.figures(), .faults = faults_, .warnings = meter.warnings()};
}

rig::record::Summary summary_of(const rig::record::Summary& head, const Outcome& outcome, const std::vector<rig::Band>& bands) {
    rig::record::Summary summary = head;
    const bool finished = outcome.phase == rig::Phase::finished;
    summary.outcome = finished ? name(outcome.phase) : name(outcome.abort);
    summary.figures = outcome.figures;
    summary.warnings = outcome.warnings;
    summary.cumulative_energy_J += outcome.figures.energy_brake_J;
    summary.faults = antiskid::can::fault_names(outcome.faults);
    if (finished && !bands.empty()) summary.out_of_tolerance = rig::out_of_tolerance(bands, summary.figures);
    return summary;
}

}  // namespace endurance
