#include "plant_sim/study/trajectory.hpp"

#include <fmt/format.h>

#include <iterator>

#include "firmware/can/value_names.hpp"

namespace study {

namespace {
constexpr double kRow_s = 5e-3;
}

Trajectory::Trajectory(bool along_runway)
    : along_runway_(along_runway),
      csv_(
          "time_s,speed_mps,wheel_rim_speed_mps,slip,slip_reference,pressure_demand_Pa,pressure_Pa,current_"
          "mA,brake_torque_Nm,"
          "F_x_N,F_z_N,radius_m,mu,energy_brake_J,energy_tyre_J,state") {
    csv_ += along_runway ? ",runway_m,mu_max\n" : "\n";
}

void Trajectory::record(const RigSession& session, const antiskid::can::ControllerView& controller, double current_mA) {
    const plant::Rig& rig = session.rig();
    if (rig.time_s() < static_cast<double>(rows_) * kRow_s) return;
    ++rows_;
    const plant::WheelState& w = rig.wheel();
    const plant::Forces f = rig.forces();
    fmt::format_to(std::back_inserter(csv_),
                   "{:.3f},{:.5f},{:.5f},{:.5f},{:.4f},{:.0f},{:.0f},{:.3f},{:.2f},{:.2f},{:.2f},{:.6f},{:."
                   "6f},{:.1f},{:.1f},{}",
                   rig.time_s(), w.v_mps, w.omega_radps * f.radius_m, f.slip, controller.slip_reference, session.sample().maneuver.demand_Pa,
                   rig.pressure_Pa(), current_mA, f.brake_torque_Nm, f.F_x_N, f.F_z_N, f.radius_m, f.mu, w.energy_brake_J, w.energy_tyre_J,
                   antiskid::can::kStateNames[static_cast<std::size_t>(controller.state)]);
    if (along_runway_) fmt::format_to(std::back_inserter(csv_), ",{:.3f},{:.6f}", rig.runway_m(), rig::peak(rig.surface(), w.v_mps).mu);
    csv_ += '\n';
}

}  // namespace study
