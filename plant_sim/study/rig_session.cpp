#include "plant_sim/study/rig_session.hpp"

#include <cmath>
#include <stdexcept>

#include "plant_sim/plc/speed_sample.hpp"

namespace study {

namespace {

constexpr double kPlantStep_s = 1e-3;

int plant_steps(double period_s) {
    const double steps = period_s / kPlantStep_s;
    if (steps < 0.999 || std::abs(steps - std::round(steps)) > 1e-6) {
        throw std::invalid_argument("the control period must be a whole number of milliseconds");
    }
    return static_cast<int>(std::lround(steps));
}

}  // namespace

RigSession::RigSession(const rig::RigParameters& rig, const SessionOptions& options)
    : options_(options),
      plant_steps_(plant_steps(options.period_s)),
      rig_(rig, kPlantStep_s, options.seed),
      pilot_(options.plan),
      meter_(options.plan.slip_reference, options.drop_out_mps) {
    sense();
}

void RigSession::sense() {
    const double now = rig_.time_s();
    sample_.wheel = plc::speed_sample(rig_.wheel_encoder(), now);
    sample_.flywheel = plc::speed_sample(rig_.flywheel_encoder(), now);
    sample_.pressure_Pa = static_cast<float>(rig_.measured_pressure_Pa());
    sample_.maneuver = pilot_.command();
    if (!options_.slip_reference) return;
    const double asked = options_.slip_reference(rig_);
    meter_.ask(asked);
    sample_.maneuver.slip_reference = static_cast<float>(asked);
}

antiskid::can::LoadCellSample RigSession::load_cells() const {
    const plant::Forces f = rig_.forces();
    return {.vertical_N = static_cast<float>(f.F_z_N),
            .longitudinal_N = static_cast<float>(f.F_x_N),
            .brake_torque_Nm = static_cast<float>(f.brake_torque_Nm)};
}

void RigSession::advance(double current_mA, antiskid::control::State controller) {
    meter_.command(current_mA);
    for (int i = 0; i < plant_steps_; ++i) {
        rig_.advance_current(current_mA);
        if (!measure()) break;
    }
    close_period(controller);
}

/// False: the stop is over.
bool RigSession::measure() {
    if (!meter_.started() || pilot_.phase() != StopPhase::braking) return true;
    meter_.update(rig_, kPlantStep_s);
    if (!rig_.standstill()) return true;
    result_ = meter_.figures(rig_);
    return false;
}

void RigSession::close_period(antiskid::control::State controller) {
    const bool given_up = controller == antiskid::control::State::safe && pilot_.phase() == StopPhase::braking;
    safe_s_ = given_up ? safe_s_ + options_.period_s : 0.0;
    const StopPhase before = pilot_.phase();
    pilot_.update(rig_.time_s(), rig_.standstill());
    if (pilot_.phase() != StopPhase::approach && before == StopPhase::approach) rig_.touch_down();
    if (pilot_.phase() == StopPhase::braking && before != StopPhase::braking) meter_.start(rig_);
    if (timed_out() || abandoned()) result_ = meter_.figures(rig_);
    sense();
}

}  // namespace study
