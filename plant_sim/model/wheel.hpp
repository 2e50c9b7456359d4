/// The longitudinal and rotational dynamics of one braked wheel, eq. (1) to (5), (8) and (9), and their
/// integrator.
///
/// One model serves both modes: `mass_kg` is the aircraft's mass on the wheel (landing), or J_f / R_f^2 of a
/// flywheel whose rim speed is v. The vertical load is handed in with every step: eq. (2) in a landing, the
/// loading device's force on a rig, zero in the air.
#pragma once

#include "plant_sim/model/brake.hpp"
#include "plant_sim/model/wheel_arcs.hpp"
#include "plant_sim/model/wheel_step.hpp"
#include "rig_bridge/rig/rig_parameters.hpp"

namespace plant {

/// Motion and what it has cost since the start. Energies close: eq. (8) equals eq. (9).
struct WheelState {
    double v_mps = 0.0;        ///< aircraft or rim speed, >= 0
    double omega_radps = 0.0;  ///< wheel speed, >= 0: a brake never drives the wheel backwards
    double distance_m = 0.0;
    double angle_rad = 0.0;            ///< turned by the wheel
    double energy_brake_J = 0.0;       ///< integral of T_b omega
    double energy_tyre_J = 0.0;        ///< integral of F_x lambda v
    double friction_distance_m = 0.0;  ///< integral of mu v dt, the numerator of eq. (16)
    bool held = true;                  ///< wheel at rest, held by the brake or not yet spun up
};

/// Forces at one instant, for recording.
struct Forces {
    double slip;  ///< eq. (3)
    double mu;    ///< eq. (4)
    double F_x_N;
    double F_z_N;
    double radius_m;
    double brake_torque_Nm;  ///< torque that acts: at a held wheel only what balances the tyre
};

/// Integrates the wheel with ROS3 (wheel_step.hpp) and exact Jacobian. Where the wheel speed misses a fourth-order quadrature of its
/// own rates by too much, or eq. (8) misses eq. (9) (spin-up, locking), the step is halved inside, to 1/16384 at the most; locking and
/// release are located.
///
/// It remembers what it evaluated at the end of a step, for the start of the next: faster, and bit by bit the same.
class Wheel {
  public:
    /// Slip divides by max(v, kSlowest_mps): at and below it the maneuver is at standstill and nothing moves any more.
    static constexpr double kSlowest_mps = wheel_step::kSlowest_mps;

    /// Of the wheel speed relative to free rolling, and of the wheel's energy, in one step or part of it.
    static constexpr double kTolerance = 1e-7;

    Wheel(const rig::WheelParameters& parameters, const BrakeTorque& brake, const rig::Surface& surface, double tolerance = kTolerance);

    /// Advances `state` by `h` seconds.
    void advance(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h);
    /// The same in one piece or not at all: returns the share of the tolerance that it took; above 1 `state` is as it was.
    double attempt(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h);

    /// Takes a step over all of an arc that was computed beside others (WheelLanes), where `advance` would have come to the same.
    /// Otherwise nothing has happened: then `advance` has to do it.
    bool take(WheelState& state, const wheel_step::Step& step);
    [[nodiscard]] const wheel_step::Law& law() const { return law_; }

    /// Another surface from here on.
    void set_tyre(const rig::FrictionLaw& tyre) {
        law_.tyre = tyre;
        last_ = {};
    }
    /// Another brake from here on.
    void set_brake(const BrakeTorque& brake) {
        law_.brake = brake;
        last_ = {};
    }

    /// At the arc's start.
    [[nodiscard]] Forces forces(const WheelState& state, double pressure_Pa, const LoadArc& load) const;

    /// m v^2 / 2 + J omega^2 / 2: eq. (8) is the difference of two of these.
    [[nodiscard]] double kinetic_energy_J(const WheelState& state) const;

  private:
    using Instant = wheel_step::Instant;
    using Step = wheel_step::Step;

    [[nodiscard]] static bool same(const Instant& at, const WheelState& state, double base_N, double load_slope, double lift);
    /// The instant at x, remembered or evaluated now.
    const Instant& start_of(const WheelState& state, const LoadArc& load, double x, double h);
    /// One step of length h with a turning wheel.
    [[nodiscard]] Step turn(const Instant& start, const PressureArc& pressure, const LoadArc& load, double h) const;
    /// To the end of a step that was taken.
    void move(WheelState& state, const Step& step);
    /// Whether the wheel, turning before, would rest or turn backwards at `reached`.
    [[nodiscard]] static bool comes_to_rest(const WheelState& state, const Instant& reached);
    /// Whether the wheel turns from `x` on: it does already, or the tyre overcomes the brake.
    [[nodiscard]] bool turns(const WheelState& state, const PressureArc& pressure, const LoadArc& load, double x) const;
    /// One step with a held wheel.
    void slide(WheelState& state, const LoadArc& load, double h) const;
    /// The wheel comes to rest inside [x0, x1] of the step: moves `state` there and returns the place.
    double lock(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h, double x0, double x1);
    /// The tyre begins to turn a held wheel inside [x0, 1]: moves `state` there and returns the place.
    double release(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h, double x0) const;
    /// Torque by which the brake exceeds what the tyre can turn: above zero a wheel at rest stays at rest.
    [[nodiscard]] double holding_margin_Nm(const WheelState& state, double pressure, const LoadArc& load, double x) const;

    rig::WheelParameters parameters_;
    wheel_step::Law law_;
    double tolerance_;
    Instant last_{};  // evaluated most recently at the start or the end of a step
};

}  // namespace plant
