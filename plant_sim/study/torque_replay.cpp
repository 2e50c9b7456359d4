#include "plant_sim/study/torque_replay.hpp"

#include <algorithm>
#include <stdexcept>

#include "plant_sim/study/stop_meter.hpp"
#include "rig_bridge/rig/friction_curve.hpp"

namespace study {

namespace {

constexpr double kReplayStep_s = 1e-3;

rig::RigParameters rig_of(const rig::LoadedRig& loaded, const wear::Braking& braking) {
    if (!(braking.brake_on_mps > 0.0 && braking.mean_torque_Nm > 0.0 && braking.mean_load_N > 0.0))
        throw std::invalid_argument("a stop by its torque needs speed, torque and load above zero");
    rig::RigParameters p = loaded.rig;
    p.brake_on_mps = braking.brake_on_mps;
    p.load = {.base_N = braking.mean_load_N, .lift_Ns2pm2 = 0.0, .lag_s = 0.0};
    return p;
}

}  // namespace

TorqueStop stop_by_torque(const rig::LoadedRig& loaded, const wear::Braking& braking) {
    const rig::RigParameters p = rig_of(loaded, braking);
    const plant::BrakeTorque brake(p.brake, p.friction_curve, p.mean_friction, p.brake_on_mps);
    plant::Rig rig(p, kReplayStep_s, 1);
    rig.touch_down();
    rig.start_rolling();
    StopMeter meter(0.0, loaded.drop_out_mps);
    meter.start(rig);
    TorqueStop out;
    while (!rig.standstill() && rig.time_s() < kLongestTorqueStop_s) {
        const double wanted_Pa = braking.mean_torque_Nm / brake.gain(rig.wheel().v_mps).k_b;
        out.short_of_pressure = out.short_of_pressure || wanted_Pa > loaded.full_pressure_Pa;
        const double pressure_Pa = std::min(wanted_Pa, loaded.full_pressure_Pa);
        rig.advance_pressure(pressure_Pa, pressure_Pa);
        meter.update(rig, kReplayStep_s);
    }
    const StopFigures f = meter.figures(rig);
    out.mean_friction = f.mean_friction;
    out.energy_brake_J = f.energy_brake_J;
    out.duration_s = f.duration_s;
    out.length_m = f.stop_distance_m;
    return out;
}

TorqueReplay replay_torques(const wear::Campaign& recorded, const rig::LoadedRig& loaded, wear::WearingBrake brake,
                            const std::function<void(std::size_t)>& progress) {
    if (recorded.brakings.size() != recorded.points.size()) throw std::invalid_argument(recorded.source + ": no braking torque is recorded");
    rig::LoadedRig rig = loaded;
    TorqueReplay out;
    out.simulated.source = recorded.source + ", simulated";
    out.simulated.points.reserve(recorded.points.size());
    const double start_J = brake.state().c_e_J;
    for (const wear::Braking& braking : recorded.brakings) {
        // The model is one of readings of eq. (7). NaN, if no brake reads so little, becomes the smallest possible friction.
        const double mean = rig::mean_of_measured(rig.rig.friction_curve, brake.next_friction(), rig.drop_out_mps / braking.brake_on_mps);
        rig.rig.mean_friction = std::fmax(mean, rig::min_mean_friction(rig.rig.friction_curve));
        const TorqueStop stop = stop_by_torque(rig, braking);
        brake.take(stop.energy_brake_J);
        out.simulated.points.push_back({brake.state().c_e_J, stop.mean_friction});
        out.short_of_pressure += stop.short_of_pressure ? 1 : 0;
        if (progress) progress(out.simulated.points.size());
    }
    const double recorded_J = recorded.points.back().c_e_J - start_J;
    out.energy_error = (brake.state().c_e_J - start_J) / recorded_J - 1.0;
    return out;
}

}  // namespace study
