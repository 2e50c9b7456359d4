#include "plant_sim/study/stop_meter.hpp"

#include <algorithm>
#include <cmath>

namespace study {

StopMeter::StopMeter(double slip_reference, double drop_out_mps) : slip_reference_(slip_reference), drop_out_mps_(drop_out_mps) {}

void StopMeter::command(double current_mA) {
    if (started_ && !dropped_out_ && current_mA_) travel_mA_ += std::abs(current_mA - *current_mA_);
    current_mA_ = current_mA;
}

void StopMeter::start(const plant::Rig& rig) {
    started_ = true;
    start_ = last_ = drop_out_ = rig.wheel();
    start_s_ = drop_out_s_ = rig.time_s();
    start_energy_J_ = rig.kinetic_energy_J();
    start_leg_J_ = rig.energy_leg_J();
    set_surface(rig.surface());
}

void StopMeter::set_surface(const rig::Surface& surface) {
    changed_ = surface_ != nullptr || surface.wet;
    surface_ = &surface;
    optimum_ = rig::peak(surface);
}

void StopMeter::update(const plant::Rig& rig, double step_s) {
    const plant::WheelState& now = rig.wheel();
    const plant::Forces forces = rig.forces();
    const double metres = now.distance_m - last_.distance_m;
    if (&rig.surface() != surface_) set_surface(rig.surface());
    if (surface_->wet) optimum_ = rig::peak(*surface_, 0.5 * (last_.v_mps + now.v_mps));
    torque_Nms_ += forces.brake_torque_Nm * step_s;
    load_Ns_ += forces.F_z_N * step_s;
    if (!dropped_out_) {
        sliding_torque_Nms_ += forces.brake_torque_Nm * step_s;
        pressure_Pas_ += rig.parameters().clamping.net_Pa(rig.pressure_Pa()) * step_s;
        drop_out_ = now;
        drop_out_s_ = rig.time_s();
        dropped_out_ = now.v_mps <= drop_out_mps_;
        peak_slip_ = std::max(peak_slip_, forces.slip);
        efficiency_m_ += slip_efficiency(forces.slip, optimum_.slip) * metres;
        max_friction_m_ += optimum_.mu * metres;
        lock_s_ = forces.slip > kLockSlip ? lock_s_ + step_s : 0.0;
        longest_lock_s_ = std::max(longest_lock_s_, lock_s_);
        if (rig.time_s() - start_s_ > kTrackingStarts_s && now.v_mps > kTrackingEnds_mps) {
            tracking_m_ += metres;
            tracking_brake_J_ += now.energy_brake_J - last_.energy_brake_J;
            tracking_tyre_J_ += now.energy_tyre_J - last_.energy_tyre_J;
            if (std::abs(forces.slip - slip_reference_) <= kTrackingBand) tracked_m_ += metres;
        }
    }
    last_ = now;
}

StopFigures StopMeter::figures(const plant::Rig& rig) const {
    const plant::WheelState& now = rig.wheel();
    const double to_drop_out = drop_out_.distance_m - start_.distance_m;
    StopFigures f;
    f.stop_distance_m = now.distance_m - start_.distance_m;
    f.duration_s = rig.time_s() - start_s_;
    f.drop_out_distance_m = to_drop_out;
    const double max_m = changed_ ? max_friction_m_ : optimum_.mu * to_drop_out;
    f.j_mu = to_drop_out > 0.0 ? (drop_out_.friction_distance_m - start_.friction_distance_m) / max_m : 0.0;
    f.slip_efficiency = to_drop_out > 0.0 ? efficiency_m_ / to_drop_out : 0.0;
    f.energy_brake_J = now.energy_brake_J - start_.energy_brake_J;
    f.energy_tyre_J = now.energy_tyre_J - start_.energy_tyre_J;
    const double leg_J = rig.energy_leg_J() - start_leg_J_;
    const double work = start_energy_J_ - rig.kinetic_energy_J();
    f.energy_residual = work > 0.0 ? (work - f.energy_brake_J - f.energy_tyre_J - leg_J) / work : 0.0;
    f.peak_slip = peak_slip_;
    f.longest_lock_s = longest_lock_s_;
    if (tracking_m_ > 0.0) f.tracked_share = tracked_m_ / tracking_m_;
    const double tracking_J = tracking_brake_J_ + tracking_tyre_J_;
    if (tracking_J > 0.0) f.tracked_tyre_share = tracking_tyre_J_ / tracking_J;
    if (pressure_Pas_ > 0.0) f.mean_friction = sliding_torque_Nms_ / pressure_Pas_ / rig.parameters().brake.gain_m3();
    if (f.duration_s > 0.0) {
        f.mean_torque_Nm = torque_Nms_ / f.duration_s;
        f.mean_load_N = load_Ns_ / f.duration_s;
    }
    if (current_mA_ && drop_out_s_ > start_s_) f.valve_travel_mAps = travel_mA_ / (drop_out_s_ - start_s_);
    f.standstill = rig.standstill();
    return f;
}

}  // namespace study
