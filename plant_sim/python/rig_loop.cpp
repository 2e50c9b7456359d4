#include "plant_sim/python/rig_loop.hpp"

#include <stdexcept>
#include <utility>

#include "firmware/control/valve_model.hpp"
#include "firmware/host/seconds.hpp"
#include "plant_sim/study/loop.hpp"

namespace plant_sim::python {

RigLoop::RigLoop(std::shared_ptr<const Scenario> scenario)
    : scenario_(std::move(scenario)),
      session_(scenario_->inputs().plant.rig, scenario_->inputs().session),
      period_(study::period_of(scenario_->inputs().controller)),
      link_(scenario_->inputs().layout, period_) {}

double RigLoop::period_s() const {
    return antiskid::host::seconds(period_);
}

double RigLoop::current_for_mA(double pressure_Pa) const {
    return static_cast<double>(antiskid::control::valve_current_mA(scenario_->inputs().controller.valve, static_cast<float>(pressure_Pa)));
}

const antiskid::control::Sensors& RigLoop::sensors() {
    if (sensed_ == nullptr) sensed_ = &link_.sense(session_.sample(), now());
    return *sensed_;
}

void RigLoop::advance(double current_mA, antiskid::control::State state) {
    if (done()) throw std::runtime_error("the maneuver is over");
    (void)sensors();  // the schedule of the frames goes on, whoever listens
    session_.advance(current_mA, state);
    sensed_ = nullptr;
    ++steps_;
}

void RigLoop::apply(const antiskid::control::Command& command) {
    faults_.insert(command.faults);
    advance(static_cast<double>(link_.current_mA(command)), command.state);
}

py::object RigLoop::figures() const {
    study::RunResult result;
    result.figures = session_.figures();
    result.faults = faults_;
    const study::SessionOptions& options = scenario_->inputs().session;
    return scenario_->figures(result, options.plan.slip_reference, options.seed);
}

}  // namespace plant_sim::python
