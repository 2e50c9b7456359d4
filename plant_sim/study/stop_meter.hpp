/// Measures one braking maneuver from the plant's true state: distance, J_mu, energies, slip, locks.
#pragma once

#include <optional>

#include "plant_sim/model/rig.hpp"

namespace study {

/// Figures of one stop. Distances, times and energies count from brake-on. J_mu, eq. (16), ends at drop-out, the others at standstill.
struct StopFigures {
    double stop_distance_m = 0.0;
    double duration_s = 0.0;
    double drop_out_distance_m = 0.0;  ///< distance at which the speed fell below drop-out
    double j_mu = 0.0;                 ///< eq. (16) from brake-on; mu_max is the peak friction of the surface under the wheel at its speed
    double energy_brake_J = 0.0;       ///< integral of T_b omega, eq. (9)
    double energy_tyre_J = 0.0;        ///< integral of F_x lambda v, eq. (9)
    double energy_residual = 0.0;      ///< (eq. 8 - eq. 9) / eq. 8
    double peak_slip = 0.0;            ///< above drop-out speed
    double longest_lock_s = 0.0;       ///< longest time with slip above 0.95, above drop-out speed
    double slip_efficiency = 0.0;      ///< wheel-slip efficiency, over the distance down to drop-out
    /// Share of the distance with slip within 0.05 of the reference, see StopMeter; none: not measured.
    std::optional<double> tracked_share;
    /// Share of the tyre in the energy of brake and tyre over that distance, eq. (9); none: no energy.
    std::optional<double> tracked_tyre_share;
    double mean_friction = 0.0;  ///< eq. (7) down to drop-out: mean torque over mean pressure and geometry
    double mean_torque_Nm = 0.0;
    double mean_load_N = 0.0;
    /// Sum of the valve current's changes, divided by the time down to drop-out; none: no current was commanded.
    std::optional<double> valve_travel_mAps;
    bool standstill = false;
    bool operator==(const StopFigures&) const = default;
};

/// Wheel-slip efficiency at an instant, 0 to 1, as in certification (FAA AC 25-7). `optimum`: slip of the greatest friction, above 0 and at most 1. 0
/// for negative slip: a wheel that is too fast does not brake.
[[nodiscard]] inline double slip_efficiency(double slip, double optimum) {
    if (slip > optimum) return 0.5 * (1.0 + (1.0 - slip) / (1.0 - optimum));
    const double q = slip > 0.0 ? slip / optimum : 0.0;
    return q * (1.5 - 0.5 * q * q);
}

class StopMeter {
  public:
    /// `tracked_share` and `tracked_tyre_share` count from 0.5 s after brake-on down to 20 m/s; a stop from a lower speed has neither.
    static constexpr double kTrackingStarts_s = 0.5;
    static constexpr double kTrackingEnds_mps = 20.0;
    static constexpr double kTrackingBand = 0.05;
    static constexpr double kLockSlip = 0.95;

    StopMeter(double slip_reference, double drop_out_mps);

    /// Sets the slip reference from now on.
    void ask(double slip_reference) { slip_reference_ = slip_reference; }
    /// Call in each control period, also before brake-on, with the current that the valve gets.
    void command(double current_mA);

    /// Call at brake-on: all figures count from here.
    void start(const plant::Rig& rig);
    /// Call after every plant step of `step_s` since start().
    void update(const plant::Rig& rig, double step_s);

    [[nodiscard]] bool started() const { return started_; }
    [[nodiscard]] double distance_m(const plant::Rig& rig) const { return rig.wheel().distance_m - start_.distance_m; }
    [[nodiscard]] StopFigures figures(const plant::Rig& rig) const;

  private:
    void set_surface(const rig::Surface& surface);

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
    bool changed_ = false;         // whether the surface has changed
    double efficiency_m_ = 0.0;
    double torque_Nms_ = 0.0;
    double sliding_torque_Nms_ = 0.0;  // down to drop-out, as the pressure's integral: a held wheel shows no friction
    double pressure_Pas_ = 0.0;
    double load_Ns_ = 0.0;
};

}  // namespace study
