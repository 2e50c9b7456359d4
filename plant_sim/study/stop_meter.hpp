/// Measures one braking maneuver from the plant's true state: distance, J_mu, energies, slip, locks.
#pragma once

#include <optional>

#include "plant_sim/model/rig.hpp"

namespace study {

/// One stop. Distances, times and energies count from brake-on; J_mu (eq. 16) ends at drop-out, the rest at
/// standstill.
struct StopFigures {
    double stop_distance_m = 0.0;
    double duration_s = 0.0;
    double drop_out_distance_m = 0.0;  ///< distance at which the speed fell below drop-out
    double j_mu = 0.0;                 ///< eq. (16), pressure build-up included; mu_max is what the surface under the wheel offers at its speed
    double energy_brake_J = 0.0;       ///< integral of T_b omega, eq. (9)
    double energy_tyre_J = 0.0;        ///< integral of F_x lambda v, eq. (9)
    double energy_residual = 0.0;      ///< (eq. 8 - eq. 9) / eq. 8
    double peak_slip = 0.0;            ///< above drop-out speed
    double longest_lock_s = 0.0;       ///< longest time with slip above 0.95, above drop-out speed
    double slip_efficiency = 0.0;      ///< wheel-slip efficiency, over the distance down to drop-out
    /// Share of the distance with slip within 0.05 of the reference, see below; none where nothing was measured.
    std::optional<double> tracked_share;
    /// The tyre's share of what brake and tyre took over that distance, eq. (9); none where they took nothing.
    std::optional<double> tracked_tyre_share;
    double mean_friction = 0.0;  ///< eq. (7) down to drop-out: mean torque over mean pressure and geometry
    double mean_torque_Nm = 0.0;
    double mean_load_N = 0.0;
    /// Travel of the valve current over the time down to drop-out; none where no current was commanded.
    std::optional<double> valve_travel_mAps;
    bool standstill = false;
    bool operator==(const StopFigures&) const = default;
};

/// Wheel-slip efficiency at an instant, 0 to 1, as certification counts it (FAA AC 25-7): `optimum` is the slip of the greatest friction,
/// above 0 and at most 1. Zero at negative slip: an overspeeding wheel does not brake.
[[nodiscard]] inline double slip_efficiency(double slip, double optimum) {
    if (slip > optimum) return 0.5 * (1.0 + (1.0 - slip) / (1.0 - optimum));
    const double q = slip > 0.0 ? slip / optimum : 0.0;
    return q * (1.5 - 0.5 * q * q);
}

class StopMeter {
  public:
    /// `tracked_share` and `tracked_tyre_share` count from 0.5 s after brake-on down to 20 m/s: a stop from less has neither.
    static constexpr double kTrackingStarts_s = 0.5;
    static constexpr double kTrackingEnds_mps = 20.0;
    static constexpr double kTrackingBand = 0.05;
    static constexpr double kLockSlip = 0.95;

    StopMeter(double slip_reference, double drop_out_mps);

    /// What is asked for from now on, instead of the reference given at construction.
    void ask(double slip_reference) { slip_reference_ = slip_reference; }
    /// The current that the valve gets from now on: every control period, before brake-on too.
    void command(double current_mA);

    /// Brake-on: everything counts from here.
    void start(const plant::Rig& rig);
    /// After every plant step of `step_s`, once started.
    void update(const plant::Rig& rig, double step_s);

    [[nodiscard]] bool started() const { return started_; }
    [[nodiscard]] double distance_m(const plant::Rig& rig) const { return rig.wheel().distance_m - start_.distance_m; }
    [[nodiscard]] StopFigures figures(const plant::Rig& rig) const;

  private:
    void look_at(const rig::Surface& surface);

    double slip_reference_;
    double drop_out_mps_;
    bool started_ = false;
    bool dropped_out_ = false;
    plant::WheelState start_;
    plant::WheelState drop_out_;
    plant::WheelState last_;
    double start_s_ = 0.0;
    double drop_out_s_ = 0.0;
    std::optional<double> current_mA_;
    double travel_mA_ = 0.0;  // down to drop-out
    double start_energy_J_ = 0.0;
    double start_leg_J_ = 0.0;
    double peak_slip_ = 0.0;
    double lock_s_ = 0.0;
    double longest_lock_s_ = 0.0;
    double tracking_m_ = 0.0;
    double tracked_m_ = 0.0;
    double tracking_brake_J_ = 0.0;
    double tracking_tyre_J_ = 0.0;
    rig::Peak optimum_{1.0, 1.0};  // of the surface under the wheel
    const rig::Surface* surface_ = nullptr;
    double max_friction_m_ = 0.0;  // integral of its friction over the distance down to drop-out
    bool changed_ = false;         // it was not the same all along
    double efficiency_m_ = 0.0;
    double torque_Nms_ = 0.0;
    double sliding_torque_Nms_ = 0.0;  // down to drop-out, as the pressure: a held wheel shows no friction
    double pressure_Pas_ = 0.0;
    double load_Ns_ = 0.0;
};

}  // namespace study
