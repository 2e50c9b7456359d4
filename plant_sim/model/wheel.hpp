/// Longitudinal and rotational motion of one braked wheel, eq. (1) to (5), (8) and (9), with its integrator.
///
/// One model serves both modes: `mass_kg` is the aircraft's mass on the wheel, or J_f / R_f^2 of a flywheel whose rim speed is v. The vertical load
/// is an argument of each step: eq. (2) in a landing, the loading device's force on a rig, zero in the air.
#pragma once

#include "plant_sim/model/brake.hpp"
#include "plant_sim/model/wheel_arcs.hpp"
#include "plant_sim/model/wheel_step.hpp"
#include "rig_bridge/rig/rig_parameters.hpp"

namespace plant {

/// State of motion, and energies since the start; eq. (8) equals eq. (9).
struct WheelState {
    double v_mps = 0.0;        ///< aircraft or rim speed, >= 0
    double omega_radps = 0.0;  ///< wheel speed, >= 0: a brake does not turn the wheel backwards
    double distance_m = 0.0;
    double angle_rad = 0.0;            ///< turned by the wheel
    double energy_brake_J = 0.0;       ///< integral of T_b omega
    double energy_tyre_J = 0.0;        ///< integral of F_x lambda v
    double friction_distance_m = 0.0;  ///< integral of mu v dt, the numerator of eq. (16)
    bool held = true;                  ///< wheel at rest, held by the brake or not yet spun up
};

/// Forces at one instant, for recordings.
struct Forces {
    double slip;  ///< eq. (3)
    double mu;    ///< eq. (4)
    double F_x_N;
    double F_z_N;
    double radius_m;
    double brake_torque_Nm;  ///< torque that acts; on a held wheel only what balances the tyre
};

/// Integrates the wheel with ROS3 (wheel_step.hpp) and the exact Jacobian. A step is halved, down to 1/16384, if the wheel speed differs from a
/// fourth-order quadrature of its own rates by more than the tolerance, or eq. (8) from eq. (9), as during spin-up and locking. The instants of
/// locking and release are located.
///
/// The evaluation at the end of a step is kept for the start of the next: faster, with the same bits.
class Wheel {
  public:
    /// Slip is computed with max(v, kSlowest_mps) as divisor: at and below this speed the maneuver is over and nothing moves.
    static constexpr double kSlowest_mps = wheel_step::kSlowest_mps;

    /// Largest error of one step: of the wheel speed relative to free rolling, and of the wheel's energy.
    static constexpr double kTolerance = 1e-7;

    Wheel(const rig::WheelParameters& parameters, const BrakeTorque& brake, const rig::Surface& surface, double tolerance = kTolerance);

    /// Advances `state` by `h` seconds.
    void advance(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h);
    /// Advances `state` by `h` seconds without halving. Returns the error over the tolerance; above 1 `state` is unchanged.
    double attempt(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h);

    /// Takes a step that WheelLanes has computed, if advance() would give the same. Returns false otherwise; `state` is unchanged and advance() must
    /// be called.
    bool take(WheelState& state, const wheel_step::Step& step);
    [[nodiscard]] const wheel_step::Law& law() const { return law_; }

    /// Changes the surface for the following steps.
    void set_tyre(const rig::FrictionLaw& tyre) {
        law_.tyre = tyre;
        last_ = {};
    }
    /// Changes the brake for the following steps.
    void set_brake(const BrakeTorque& brake) {
        law_.brake = brake;
        last_ = {};
    }

    /// Forces at the start of `load`.
    [[nodiscard]] Forces forces(const WheelState& state, double pressure_Pa, const LoadArc& load) const;

    /// m v^2 / 2 + J omega^2 / 2. Eq. (8) is a difference of two of these.
    [[nodiscard]] double kinetic_energy_J(const WheelState& state) const;

  private:
    using Instant = wheel_step::Instant;
    using Step = wheel_step::Step;

    [[nodiscard]] static bool same(const Instant& at, const WheelState& state, double base_N, double load_slope, double lift);
    /// The evaluation at `x`: the one that was kept, or a new one.
    const Instant& start_of(const WheelState& state, const LoadArc& load, double x, double h);
    /// One step of length `h` of a turning wheel.
    [[nodiscard]] Step turn(const Instant& start, const PressureArc& pressure, const LoadArc& load, double h) const;
    /// Moves `state` to the end of a step.
    void move(WheelState& state, const Step& step);
    /// Whether a wheel that turned before stands or turns backwards at `reached`.
    [[nodiscard]] static bool comes_to_rest(const WheelState& state, const Instant& reached);
    /// Whether the wheel turns from `x` on: it turns already, or the tyre's torque exceeds the brake's.
    [[nodiscard]] bool turns(const WheelState& state, const PressureArc& pressure, const LoadArc& load, double x) const;
    /// One step of a held wheel.
    void slide(WheelState& state, const LoadArc& load, double h) const;
    /// For a wheel that comes to rest in [x0, x1] of the step: moves `state` to that instant and returns its x.
    double lock(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h, double x0, double x1);
    /// For a held wheel that the tyre starts to turn in [x0, 1]: moves `state` to that instant and returns its x.
    double release(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h, double x0) const;
    /// Brake torque minus the largest torque of the tyre: a wheel at rest stays at rest while it is positive.
    [[nodiscard]] double holding_margin_Nm(const WheelState& state, double pressure, const LoadArc& load, double x) const;

    rig::WheelParameters parameters_;
    wheel_step::Law law_;
    double tolerance_;
    Instant last_{};  // newest evaluation at the start or end of a step
};

}  // namespace plant
