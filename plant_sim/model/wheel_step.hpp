/// One step of the wheel's integrator, as arithmetic without branches, calls or stores. Wheel uses it for one wheel, WheelLanes in a loop over
/// several, which compilers turn into vector code. Both get the same bits.
///
/// The method is ROS3 (Sandu et al., Atmospheric Environment 31, 1997, p. 3459): Rosenbrock, L-stable, order three, two evaluations.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "plant_sim/model/brake.hpp"
#include "plant_sim/model/wheel_arcs.hpp"
#include "rig_bridge/rig/tyre.hpp"

namespace plant::wheel_step {

/// Slip is computed with max(v, kSlowest_mps) as divisor.
inline constexpr double kSlowest_mps = 0.05;

/// Parameters of one wheel on one surface.
struct Law {
    double mass_kg = 0.0, per_mass = 0.0, per_inertia = 0.0, per_stiffness = 0.0, free_radius_m = 0.0;
    rig::FrictionLaw tyre;
    BrakeTorque brake;
};

/// An evaluation at one instant, of all that does not depend on pressure: inputs, forces, partial derivatives.
struct Instant {
    double v = -1.0, omega = 0.0, base_N = 0.0, load_slope = 0.0, lift = 0.0;
    double per_v = 0.0, F_z = 0.0, r = 0.0, slip = 0.0, mu = 0.0, mu_1 = 0.0, F_x = 0.0, k_b = 0.0, k_b1 = 0.0, v_dot = 0.0;
    double r_1 = 0.0, r_t = 0.0, slip_v = 0.0, slip_omega = 0.0, slip_t = 0.0, F_v = 0.0, F_omega = 0.0, F_t = 0.0;
};

/// Elements of the Jacobian that depend on pressure, and the integrands of the sums with their total derivatives by time.
struct Rates {
    double omega_dot, omega_ddot;
    double a21, t2;  // partial derivatives of omega_dot by v and by time
    double brake_W, tyre_W, friction_mps;
    double brake_rate, tyre_rate, friction_rate;
};

/// Increments of the sums in WheelState.
struct Sums {
    double distance_m = 0.0, angle_rad = 0.0, energy_brake_J = 0.0, energy_tyre_J = 0.0, friction_distance_m = 0.0;
};

struct Step {
    Instant end;
    Sums sums;
    double error = 0.0;  ///< of omega, relative to free rolling; infinite if the wheel may have turned backwards within the step
};

[[gnu::always_inline]] inline Instant instant(const Law& law, double v, double omega, double base_N, double load_slope, double lift) {
    const double per_v = 1.0 / std::max(v, kSlowest_mps);
    const double F_z = base_N - lift * v * v;
    const double r = law.free_radius_m - F_z * law.per_stiffness;
    const double slip = (v - omega * r) * per_v;
    const rig::Friction f = friction(law.tyre, slip);
    const double F_x = F_z * f.mu;
    const BrakeTorque::Gain gain = law.brake.gain(v);

    const double F_z1 = -2.0 * lift * v;
    const double stiffness = F_z * f.mu_1;
    const double r_1 = -F_z1 * law.per_stiffness;
    const double slip_v = (1.0 - (v > kSlowest_mps ? slip : 0.0) - omega * r_1) * per_v;
    const double slip_omega = -r * per_v;
    // The rate of the load changes force and radius, which makes both depend on time explicitly.
    const double r_t = -load_slope * law.per_stiffness;
    const double slip_t = -omega * r_t * per_v;
    return {.v = v,
            .omega = omega,
            .base_N = base_N,
            .load_slope = load_slope,
            .lift = lift,
            .per_v = per_v,
            .F_z = F_z,
            .r = r,
            .slip = slip,
            .mu = f.mu,
            .mu_1 = f.mu_1,
            .F_x = F_x,
            .k_b = gain.k_b,
            .k_b1 = gain.k_b1,
            .v_dot = -F_x * law.per_mass,
            .r_1 = r_1,
            .r_t = r_t,
            .slip_v = slip_v,
            .slip_omega = slip_omega,
            .slip_t = slip_t,
            .F_v = F_z1 * f.mu + stiffness * slip_v,
            .F_omega = stiffness * slip_omega,
            .F_t = load_slope * f.mu + stiffness * slip_t};
}

[[gnu::always_inline]] inline Rates rates(const Law& law, const Instant& at, double pressure, double pressure_slope) {
    const double T_b = at.k_b * pressure;
    const double T_v = at.k_b1 * pressure;
    const double T_t = at.k_b * pressure_slope;
    const double omega_dot = (at.r * at.F_x - T_b) * law.per_inertia;
    const double a21 = (at.r_1 * at.F_x + at.r * at.F_v - T_v) * law.per_inertia;
    const double t2 = (at.r_t * at.F_x + at.r * at.F_t - T_t) * law.per_inertia;

    const double slip_dot = at.slip_v * at.v_dot + at.slip_omega * omega_dot + at.slip_t;
    const double F_dot = at.F_v * at.v_dot + at.F_omega * omega_dot + at.F_t;
    const double r_dot = at.r_1 * at.v_dot + at.r_t;
    const double sliding = at.v - at.omega * at.r;
    return {.omega_dot = omega_dot,
            .omega_ddot = a21 * at.v_dot + at.r * at.F_omega * law.per_inertia * omega_dot + t2,
            .a21 = a21,
            .t2 = t2,
            .brake_W = T_b * at.omega,
            .tyre_W = at.F_x * sliding,
            .friction_mps = at.mu * at.v,
            .brake_rate = (T_v * at.v_dot + T_t) * at.omega + T_b * omega_dot,
            .tyre_rate = F_dot * sliding + at.F_x * (at.v_dot - omega_dot * at.r - at.omega * r_dot),
            .friction_rate = at.mu_1 * slip_dot * at.v + at.mu * at.v_dot};
}

/// One step of length h with a turning wheel.
[[gnu::always_inline]] inline Step turn(const Law& law, const Instant& start, const PressureArc& pressure, const LoadArc& load, double h) {
    constexpr double kGamma = 0.43586652150845899941601945119356;
    constexpr double kGamma2 = 0.24291996454816804366592249683314;
    constexpr double kGamma3 = 2.1851380027664058511513169485832;
    constexpr double kC21 = -1.0156171083877702091975600115545;
    constexpr double kC31 = 4.0759956452537699824805835358067;
    constexpr double kC32 = 9.2076794298330791242156818474003;
    constexpr double kM2 = 6.1697947043828245592553615689730;
    constexpr double kM3 = -0.42772256543218573326238373806514;

    const double per_h = 1.0 / h;
    const Rates d0 = rates(law, start, pressure.at(0.0), pressure.slope(0.0) * per_h);
    const double mid_Pa = pressure.at(kGamma);
    const double mid_N = load.base_at(kGamma);

    // (I / (gamma h) - A) u = rhs, two by two; factored once for the three stages.
    const double diagonal = per_h / kGamma;
    const double a12 = -start.F_omega * law.per_mass;
    const double b11 = diagonal + start.F_v * law.per_mass;
    const double b22 = diagonal - start.r * start.F_omega * law.per_inertia;
    const double inverse = 1.0 / (b11 * b22 - a12 * d0.a21);
    struct Stage {
        double v, omega;
    };
    const auto solve = [&](double x, double y) __attribute__((always_inline)) {
        return Stage{(b22 * x + a12 * y) * inverse, (d0.a21 * x + b11 * y) * inverse};
    };
    const auto derivatives = [&](double v, double omega) __attribute__((always_inline)) {
        const double F_z = mid_N - load.lift_Ns2pm2 * v * v;
        const double r = law.free_radius_m - F_z * law.per_stiffness;
        const double slip = (v - omega * r) * (1.0 / std::max(v, kSlowest_mps));
        const double F_x = F_z * friction(law.tyre, slip).mu;
        return Stage{-F_x * law.per_mass, (r * F_x - law.brake.gain(v).k_b * mid_Pa) * law.per_inertia};
    };

    // The third stage uses the second evaluation, too.
    const double t1 = -start.F_t * law.per_mass;
    const Stage u1 = solve(start.v_dot + kGamma * h * t1, d0.omega_dot + kGamma * h * d0.t2);
    const Stage f2 = derivatives(start.v + u1.v, start.omega + u1.omega);
    const Stage u2 = solve(f2.v + per_h * kC21 * u1.v + kGamma2 * h * t1, f2.omega + per_h * kC21 * u1.omega + kGamma2 * h * d0.t2);
    const Stage u3 = solve(f2.v + per_h * (kC31 * u1.v + kC32 * u2.v) + kGamma3 * h * t1,
                           f2.omega + per_h * (kC31 * u1.omega + kC32 * u2.omega) + kGamma3 * h * d0.t2);
    const Instant end = instant(law, start.v + u1.v + kM2 * u2.v + kM3 * u3.v, start.omega + u1.omega + kM2 * u2.omega + kM3 * u3.omega,
                                load.base_at(1.0), start.load_slope, load.lift_Ns2pm2);
    const Rates d1 = rates(law, end, pressure.at(1.0), pressure.slope(1.0) * per_h);

    // Integrals by the trapezoidal rule with end correction, fourth order.
    const double half = 0.5 * h;
    const double twelfth = h * h * (1.0 / 12.0);
    const auto integral = [ half, twelfth ](double g0, double g1, double rate0, double rate1) __attribute__((always_inline)) {
        return half * (g0 + g1) + twelfth * (rate0 - rate1);
    };
    const Sums sums{.distance_m = integral(start.v, end.v, start.v_dot, end.v_dot),
                    .angle_rad = integral(start.omega, end.omega, d0.omega_dot, d1.omega_dot),
                    .energy_brake_J = integral(d0.brake_W, d1.brake_W, d0.brake_rate, d1.brake_rate),
                    .energy_tyre_J = integral(d0.tyre_W, d1.tyre_W, d0.tyre_rate, d1.tyre_rate),
                    .friction_distance_m = integral(d0.friction_mps, d1.friction_mps, d0.friction_rate, d1.friction_rate)};

    // The same rule for omega. An error of omega's end value enters the mismatch times 1 - z/2 + z^2/12, where z is h times the pole.
    const double mismatch = end.omega - start.omega - integral(d0.omega_dot, d1.omega_dot, d0.omega_ddot, d1.omega_ddot);
    const double z = h * end.r * end.F_omega * law.per_inertia;
    const double per_rolling = end.r * end.per_v;
    const double omega_error = mismatch / (1.0 - z * (0.5 - z * (1.0 / 12.0))) * per_rolling;
    // Eq. (8) against eq. (9), relative to the wheel's energy in free rolling. Either estimate sees what the other misses.
    const double energy_error = 0.5 * law.mass_kg * law.per_inertia * (end.v - start.v) * (end.v + start.v) +
                                0.5 * (end.omega - start.omega) * (end.omega + start.omega) +
                                (sums.energy_brake_J + sums.energy_tyre_J) * law.per_inertia;
    const double error = std::max(std::abs(omega_error), std::abs(energy_error) * per_rolling * per_rolling);

    // A wheel that comes to rest and starts again within the step would turn backwards in between: a cubic falls below its ends by at most 4/27 of
    // its slopes. No `&&`: it would branch.
    const double dip = 4.0 / 27.0 * h * (d1.omega_dot - d0.omega_dot);
    const double min = d0.omega_dot < 0.0 ? std::min(start.omega, end.omega) : dip;
    const bool backwards = (d1.omega_dot > 0.0 ? min : dip) < dip;
    return {end, sums, backwards ? std::numeric_limits<double>::infinity() : error};
}

}  // namespace plant::wheel_step
