#include "plant_sim/study/trajectory.hpp"

#include "firmware/can/value_names.hpp"

namespace study {

namespace {
constexpr double kRow_s = 5e-3;
}

Trajectory::Trajectory(bool along_runway)
    : along_runway_(along_runway),
      csv_(settings::TextTable::csv(
          std::string("time_s:.3f|speed_mps:.5f|wheel_rim_speed_mps:.5f|slip:.5f|slip_reference:.4f|pressure_demand_Pa:.0f|pressure_Pa:.0f|current_"
                      "mA:.3f|brake_torque_Nm:.2f|F_x_N:.2f|F_z_N:.2f|radius_m:.6f|mu:.6f|energy_brake_J:.1f|energy_tyre_J:.1f|state") +
          (along_runway ? "|runway_m:.3f|mu_max:.6f" : ""))) {}

void Trajectory::record(const RigSession& session, const antiskid::can::ControllerView& controller, double current_mA) {
    const plant::Rig& rig = session.rig();
    if (rig.time_s() < static_cast<double>(rows_.size()) * kRow_s) return;
    const plant::WheelState& w = rig.wheel();
    const plant::Forces f = rig.forces();
    rows_.push_back({rig.time_s(), w.v_mps, w.omega_radps * f.radius_m, f.slip, controller.slip_reference, session.sample().maneuver.demand_Pa,
                     rig.pressure_Pa()});
    pictures::StopRow& row = rows_.back();
    csv_.add(row.time_s, row.speed_mps, row.wheel_rim_speed_mps, row.slip, row.slip_reference, row.demand_Pa, row.pressure_Pa, current_mA,
             f.brake_torque_Nm, f.F_x_N, f.F_z_N, f.radius_m, f.mu, w.energy_brake_J, w.energy_tyre_J,
             antiskid::can::kStateNames[static_cast<std::size_t>(controller.state)]);
    if (!along_runway_) return;
    const double mu_max = rig::peak(rig.surface(), w.v_mps).mu;
    csv_.add(rig.runway_m(), mu_max);
    if (f.F_z_N > 0.0) row.friction = {rig.runway_m(), f.mu, mu_max};
}

}  // namespace study
