/// The longitudinal and rotational dynamics of one braked wheel, eq. (1) to (5), (8) and (9), and their
/// integrator.
///
/// One model serves both modes: `mass_kg` is the aircraft's mass on the wheel (landing), or J_f / R_f^2 of a
/// flywheel whose rim speed is v. The vertical load is handed in with every step: eq. (2) in a landing, the
/// loading device's force on a rig, zero in the air.
#pragma once

#include <array>
#include <cstddef>

#include "plant_sim/model/brake.hpp"
#include "plant_sim/model/tyre.hpp"

namespace plant {

struct WheelParameters {
    double mass_kg = 0.0;        ///< m_a, or J_f / R_f^2
    double inertia_kgm2 = 0.0;   ///< J_w
    double free_radius_m = 0.0;  ///< r_0 of r(F_z) = r_0 - F_z / k_r
    double stiffness_Npm = 0.0;  ///< k_r
};

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

/// Brake pressure over one step of length h as a cubic in x = t/h in [0, 1], never negative where it is used.
/// Exact for a linear profile; for the valve of eq. (6) at 1 ms the cubic through value and rate at both ends
/// is within 1e-6.
struct PressureArc {
    double c0 = 0.0, c1 = 0.0, c2 = 0.0, c3 = 0.0;

    [[nodiscard]] static PressureArc linear(double p0, double p1) { return {p0, p1 - p0, 0.0, 0.0}; }
    /// Rates are per second, `h` in seconds.
    [[nodiscard]] static PressureArc hermite(double p0, double rate0, double p1, double rate1, double h) {
        const double m0 = rate0 * h;
        const double m1 = rate1 * h;
        return {p0, m0, 3.0 * (p1 - p0) - 2.0 * m0 - m1, 2.0 * (p0 - p1) + m0 + m1};
    }
    [[nodiscard]] double at(double x) const {
        const double p = c0 + x * (c1 + x * (c2 + x * c3));
        return p > 0.0 ? p : 0.0;
    }
    /// dp/dx; nothing where the pressure is held at zero.
    [[nodiscard]] double slope(double x) const {
        return c0 + x * (c1 + x * (c2 + x * c3)) < 0.0 ? 0.0 : c1 + x * (2.0 * c2 + x * 3.0 * c3);
    }
    /// The part of the arc between x0 and x1, again over [0, 1].
    [[nodiscard]] PressureArc part(double x0, double x1) const;
};

/// Vertical load over one step: F_z = base + x * change - lift * v^2, x = t/h in [0, 1].
struct LoadArc {
    double base_N = 0.0;       ///< m g in a landing, the loading device's force on a rig, 0 in the air
    double change_N = 0.0;     ///< of the base over the whole step
    double lift_Ns2pm2 = 0.0;  ///< rho S C_l / 2 of eq. (2); 0 where the load does not depend on speed

    [[nodiscard]] double base_at(double x) const { return base_N + x * change_N; }
    [[nodiscard]] double force_N(double x, double v_mps) const {
        return base_at(x) - lift_Ns2pm2 * v_mps * v_mps;
    }
    [[nodiscard]] LoadArc part(double x0, double x1) const {
        return {base_at(x0), (x1 - x0) * change_N, lift_Ns2pm2};
    }
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

/// Integrates the wheel with an L-stable Rosenbrock method of order three and two evaluations a step (ROS3: Sandu et al., Atmospheric
/// Environment 31, 1997, p. 3459) with exact Jacobian. Where the wheel speed misses a fourth-order quadrature of its
/// own rates by too much, or eq. (8) misses eq. (9) (spin-up, locking), the step is halved inside, to 1/16384 at the most; locking and
/// release are located.
///
/// It remembers what it evaluated at the end of a step, for the start of the next: faster, and bit by bit the same.
class Wheel {
  public:
    /// Slip divides by max(v, kSlowest_mps): at and below it the maneuver is at standstill and nothing moves any more.
    static constexpr double kSlowest_mps = 0.05;

    /// Of the wheel speed relative to free rolling, and of the wheel's energy, in one step or part of it.
    static constexpr double kTolerance = 1e-7;

    Wheel(const WheelParameters& parameters, const BrakeTorque& brake, const Surface& surface,
          double tolerance = kTolerance);

    /// Advances `state` by `h` seconds.
    void advance(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h);
    /// The same in one piece or not at all: returns the share of the tolerance that it took; above 1 `state` is as it was.
    double attempt(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h);

    /// Another brake from here on.
    void set_brake(const BrakeTorque& brake) {
        brake_ = brake;
        instants_ = {};
    }

    /// At the arc's start.
    [[nodiscard]] Forces forces(const WheelState& state, double pressure_Pa, const LoadArc& load) const;

    /// m v^2 / 2 + J omega^2 / 2: eq. (8) is the difference of two of these.
    [[nodiscard]] double kinetic_energy_J(const WheelState& state) const;

  private:
    /// Everything at one instant that does not depend on pressure: first what it follows from, then forces, then partial derivatives.
    struct Instant {
        double v = -1.0, omega = 0.0, base_N = 0.0, load_slope = 0.0, lift = 0.0;
        double per_v = 0.0, F_z = 0.0, r = 0.0, slip = 0.0, mu = 0.0, mu_1 = 0.0, F_x = 0.0, k_b = 0.0,
               k_b1 = 0.0, v_dot = 0.0;
        double r_1 = 0.0, r_t = 0.0, slip_v = 0.0, slip_omega = 0.0, slip_t = 0.0, F_v = 0.0, F_omega = 0.0,
               F_t = 0.0;
    };
    struct Rates;

    [[nodiscard]] Instant instant(double v, double omega, double base_N, double load_slope,
                                  double lift) const;
    /// What a step adds to the sums in WheelState.
    struct Sums;

    [[nodiscard]] static bool same(const Instant& at, const WheelState& state, double base_N,
                                   double load_slope, double lift);
    /// The instant at x, remembered or evaluated now.
    const Instant& start_of(const WheelState& state, const LoadArc& load, double x, double h);
    [[nodiscard]] Rates rates(const Instant& at, double pressure, double pressure_slope) const;
    /// One Rosenbrock step of length h with a turning wheel from `start` to `end`; returns the error estimate of omega, as a share of free
    /// rolling.
    double turn(const Instant& start, const PressureArc& pressure, const LoadArc& load, double h,
                Instant& end, Sums& sums) const;
    static void move(WheelState& state, const Instant& end, const Sums& sums);
    /// Whether the wheel, turning before, would rest or turn backwards at `reached`.
    [[nodiscard]] static bool comes_to_rest(const WheelState& state, const Instant& reached);
    /// Whether the wheel turns from `x` on: it does already, or the tyre overcomes the brake.
    [[nodiscard]] bool turns(const WheelState& state, const PressureArc& pressure, const LoadArc& load,
                             double x) const;
    /// One step with a held wheel.
    void slide(WheelState& state, const LoadArc& load, double h) const;
    /// The wheel comes to rest inside [x0, x1] of the step: moves `state` there and returns the place.
    double lock(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h, double x0,
                double x1);
    /// The tyre begins to turn a held wheel inside [x0, 1]: moves `state` there and returns the place.
    double release(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h,
                   double x0) const;
    /// Torque by which the brake exceeds what the tyre can turn: above zero a wheel at rest stays at rest.
    [[nodiscard]] double holding_margin_Nm(const WheelState& state, double pressure, const LoadArc& load,
                                           double x) const;

    WheelParameters parameters_;
    BrakeTorque brake_;
    Surface surface_;
    double per_mass_, per_inertia_, per_stiffness_, tolerance_;
    std::array<Instant, 2> instants_{};  // start and end of the step under way, in turns
    std::size_t start_ = 0;              // which of them is the start
};

}  // namespace plant
