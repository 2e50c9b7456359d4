#include "plant_sim/model/wheel.hpp"

#include <algorithm>
#include <cmath>

namespace plant {

PressureArc PressureArc::part(double x0, double x1) const {
    const double w = x1 - x0;
    return {c0 + x0 * (c1 + x0 * (c2 + x0 * c3)), w * (c1 + x0 * (2.0 * c2 + x0 * 3.0 * c3)),
            w * w * (c2 + x0 * 3.0 * c3), w * w * w * c3};
}

/// Everything that depends on speeds, pressure and load at one instant.
struct Wheel::Local {
    double v, per_v, omega, pressure;
    double F_z, r, slip, mu, mu_1, F_x, k_b, k_b1, T_b;
    double v_dot, omega_dot;
};

/// Partial derivatives of (v_dot, omega_dot), and what the quadratures integrate with its total rates.
struct Wheel::Rates {
    double a11, a12, a21, a22;  // Jacobian
    double t1, t2;              // explicit in time
    double brake_W, tyre_W, friction_mps;
    double brake_rate, tyre_rate, friction_rate;
};

Wheel::Wheel(const WheelParameters& parameters, const BrakeTorque& brake, const Surface& surface)
    : parameters_(parameters),
      brake_(brake),
      surface_(surface),
      per_mass_(1.0 / parameters.mass_kg),
      per_inertia_(1.0 / parameters.inertia_kgm2),
      per_stiffness_(1.0 / parameters.stiffness_Npm) {}

Wheel::Local Wheel::local(double v, double omega, double pressure, const LoadArc& load, double x) const {
    Local at{};
    at.v = std::max(v, kSlowest_mps);
    at.per_v = 1.0 / at.v;
    at.omega = omega;
    at.pressure = pressure;
    at.F_z = load.force_N(x, at.v);
    at.r = parameters_.free_radius_m - at.F_z * per_stiffness_;
    at.slip = 1.0 - omega * at.r * at.per_v;
    const Friction f = friction(surface_, at.slip);
    at.mu = f.mu;
    at.mu_1 = f.mu_1;
    at.F_x = at.F_z * at.mu;
    const BrakeTorque::Gain gain = brake_.gain(at.v);
    at.k_b = gain.k_b;
    at.k_b1 = gain.k_b1;
    at.T_b = at.k_b * pressure;
    at.v_dot = -at.F_x * per_mass_;
    at.omega_dot = (at.r * at.F_x - at.T_b) * per_inertia_;
    return at;
}

Wheel::Rates Wheel::rates(const Local& at, double pressure_slope, const LoadArc& load, double h) const {
    const double load_slope = load.change_N / h;
    const double F_z1 = -2.0 * load.lift_Ns2pm2 * at.v;
    const double r_1 = -F_z1 * per_stiffness_;
    const double slip_v = (1.0 - at.slip - at.omega * r_1) * at.per_v;
    const double slip_omega = -at.r * at.per_v;
    const double F_v = F_z1 * at.mu + at.F_z * at.mu_1 * slip_v;
    const double F_omega = at.F_z * at.mu_1 * slip_omega;

    // A load that drifts changes force and radius: both explicit in time.
    const double r_t = -load_slope * per_stiffness_;
    const double slip_t = -at.omega * r_t * at.per_v;
    const double F_t = load_slope * at.mu + at.F_z * at.mu_1 * slip_t;
    const double T_t = at.k_b * pressure_slope;

    Rates d{};
    d.a11 = -F_v * per_mass_;
    d.a12 = -F_omega * per_mass_;
    d.a21 = (r_1 * at.F_x + at.r * F_v - at.k_b1 * at.pressure) * per_inertia_;
    d.a22 = at.r * F_omega * per_inertia_;
    d.t1 = -F_t * per_mass_;
    d.t2 = (r_t * at.F_x + at.r * F_t - T_t) * per_inertia_;

    const double slip_dot = slip_v * at.v_dot + slip_omega * at.omega_dot + slip_t;
    const double F_dot = F_v * at.v_dot + F_omega * at.omega_dot + F_t;
    const double r_dot = r_1 * at.v_dot + r_t;
    const double T_dot = at.k_b1 * at.v_dot * at.pressure + T_t;
    const double sliding = at.v - at.omega * at.r;
    d.brake_W = at.T_b * at.omega;
    d.tyre_W = at.F_x * sliding;
    d.friction_mps = at.mu * at.v;
    d.brake_rate = T_dot * at.omega + at.T_b * at.omega_dot;
    d.tyre_rate = F_dot * sliding + at.F_x * (at.v_dot - at.omega_dot * at.r - at.omega * r_dot);
    d.friction_rate = at.mu_1 * slip_dot * at.v + at.mu * at.v_dot;
    return d;
}

double Wheel::turn(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h) const {
    constexpr double kGamma = 0.5;
    const double per_h = 1.0 / h;
    const Local start = local(state.v_mps, state.omega_radps, pressure.at(0.0), load, 0.0);
    const Rates d0 = rates(start, pressure.slope(0.0) * per_h, load, h);

    // (I / (gamma h) - A) u = rhs, two by two, factored once for the four stages.
    const double diagonal = per_h / kGamma;
    const double b11 = diagonal - d0.a11;
    const double b22 = diagonal - d0.a22;
    const double inverse = 1.0 / (b11 * b22 - d0.a12 * d0.a21);
    struct Stage {
        double v, omega;
    };
    const auto solve = [&](double x, double y) {
        return Stage{(b22 * x + d0.a12 * y) * inverse, (d0.a21 * x + b11 * y) * inverse};
    };

    const Stage u1 = solve(start.v_dot + 0.5 * h * d0.t1, start.omega_dot + 0.5 * h * d0.t2);
    const Stage u2 = solve(start.v_dot + 4.0 * per_h * u1.v + 1.5 * h * d0.t1,
                           start.omega_dot + 4.0 * per_h * u1.omega + 1.5 * h * d0.t2);
    const double end_Pa = pressure.at(1.0);
    const Local third =
        local(state.v_mps + 2.0 * u1.v, state.omega_radps + 2.0 * u1.omega, end_Pa, load, 1.0);
    const double dv = per_h * (u1.v - u2.v);
    const double domega = per_h * (u1.omega - u2.omega);
    const Stage u3 = solve(third.v_dot + dv, third.omega_dot + domega);
    const Local fourth = local(third.v + u3.v, third.omega + u3.omega, end_Pa, load, 1.0);
    constexpr double kC43 = -8.0 / 3.0;
    const Stage u4 =
        solve(fourth.v_dot + dv + kC43 * per_h * u3.v, fourth.omega_dot + domega + kC43 * per_h * u3.omega);

    // Quadratures by the trapezoidal rule with its end correction, fourth order, from rates that are known anyway.
    const Local end = local(fourth.v + u4.v, fourth.omega + u4.omega, end_Pa, load, 1.0);
    const Rates d1 = rates(end, pressure.slope(1.0) * per_h, load, h);
    const auto integral = [h](double g0, double g1, double rate0, double rate1) {
        return 0.5 * h * (g0 + g1) + h * h / 12.0 * (rate0 - rate1);
    };
    state.distance_m += integral(start.v, end.v, start.v_dot, end.v_dot);
    state.angle_rad += integral(start.omega, end.omega, start.omega_dot, end.omega_dot);
    state.energy_brake_J += integral(d0.brake_W, d1.brake_W, d0.brake_rate, d1.brake_rate);
    state.energy_tyre_J += integral(d0.tyre_W, d1.tyre_W, d0.tyre_rate, d1.tyre_rate);
    state.friction_distance_m +=
        integral(d0.friction_mps, d1.friction_mps, d0.friction_rate, d1.friction_rate);
    state.v_mps = end.v;
    state.omega_radps = end.omega;
    return std::abs(u4.omega) * end.r * end.per_v;
}

double Wheel::holding_margin_Nm(const WheelState& state, double pressure, const LoadArc& load,
                                double x) const {
    const Local at = local(state.v_mps, 0.0, pressure, load, x);
    return at.T_b - at.r * at.F_x;
}

void Wheel::slide(WheelState& state, const LoadArc& load, double h) const {
    // Slip is 1 and mu constant: v_dot depends on F_z(v) alone, mildly. Classic fourth-order Runge-Kutta is exact to rounding.
    const double mu = friction(surface_, 1.0).mu;
    const auto v_dot = [&](double v, double x) { return -mu * load.force_N(x, v) * per_mass_; };
    const double v0 = state.v_mps;
    const double k1 = v_dot(v0, 0.0);
    const double k2 = v_dot(v0 + 0.5 * h * k1, 0.5);
    const double k3 = v_dot(v0 + 0.5 * h * k2, 0.5);
    const double k4 = v_dot(v0 + h * k3, 1.0);
    const double v1 = std::max(v0 + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4), 0.0);
    const double metres = 0.5 * h * (v0 + v1) + h * h / 12.0 * (k1 - k4);
    state.v_mps = v1;
    state.distance_m += metres;
    state.friction_distance_m += mu * metres;
    // All of the kinetic energy lost goes into the sliding tyre: F_x v dt = -m v dv.
    state.energy_tyre_J += 0.5 * parameters_.mass_kg * (v0 * v0 - v1 * v1);
}

double Wheel::lock(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h, double x0,
                   double x1) const {
    constexpr int kMostTries = 60;
    constexpr double kAtRest_radps = 1e-9;
    double lo = x0;
    double hi = x1;
    WheelState at = state;
    for (int i = 0; i < kMostTries && hi - lo > 1e-12; ++i) {
        const double x = 0.5 * (lo + hi);
        at = state;
        turn(at, pressure.part(x0, x), load.part(x0, x), (x - x0) * h);
        if (std::abs(at.omega_radps) < kAtRest_radps) {
            hi = x;
            break;
        }
        (at.omega_radps > 0.0 ? lo : hi) = x;
    }
    // What is left of the wheel's energy is rounding.
    at.omega_radps = 0.0;
    at.held = true;
    state = at;
    return hi;
}

double Wheel::release(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h,
                      double x0) const {
    double lo = x0;
    double hi = 1.0;
    WheelState at = state;
    while (hi - lo > 1e-9) {
        const double x = 0.5 * (lo + hi);
        at = state;
        slide(at, load.part(x0, x), (x - x0) * h);
        (holding_margin_Nm(at, pressure.at(x), load, x) >= 0.0 ? lo : hi) = x;
    }
    at = state;
    slide(at, load.part(x0, hi), (hi - x0) * h);
    state = at;
    return hi;
}

void Wheel::advance(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h) const {
    if (state.v_mps <= kSlowest_mps) return;
    // The estimate is that of an embedded second-order method: the solution itself is better than this.
    constexpr double kTolerance = 1e-4;
    constexpr double kSmallest = 1.0 / 256.0;
    constexpr double kNoTime = 1e-9;
    constexpr int kMostParts = 1024;  // keeps chatter between turning and held finite
    double x = 0.0;
    double part = 1.0;
    for (int i = 0; i < kMostParts && 1.0 - x > kNoTime; ++i) {
        const bool turns = state.omega_radps > 0.0 || holding_margin_Nm(state, pressure.at(x), load, x) < 0.0;
        if (!turns) {
            state.held = true;
            WheelState next = state;
            slide(next, load.part(x, 1.0), (1.0 - x) * h);
            if (holding_margin_Nm(next, pressure.at(1.0), load, 1.0) >= 0.0) {
                state = next;
                return;
            }
            x = release(state, pressure, load, h, x);
            part = kSmallest;
            state.held = false;
            continue;
        }
        const double end = std::min(x + part, 1.0);
        const bool whole = x == 0.0 && end == 1.0;
        WheelState next = state;
        next.held = false;
        const double error = whole ? turn(next, pressure, load, h)
                                   : turn(next, pressure.part(x, end), load.part(x, end), (end - x) * h);
        if (!(error <= kTolerance) && part > kSmallest) {
            part *= 0.5;
            continue;
        }
        if (next.omega_radps < 0.0 || (next.omega_radps == 0.0 && state.omega_radps > 0.0)) {
            x = lock(state, pressure, load, h, x, end);
            part = 1.0;
            continue;
        }
        state = next;
        x = end;
        if (error < 0.125 * kTolerance) part = std::min(2.0 * part, 1.0);
    }
}

Forces Wheel::forces(const WheelState& state, double pressure_Pa, const LoadArc& load) const {
    const Local at = local(state.v_mps, state.omega_radps, std::max(pressure_Pa, 0.0), load, 0.0);
    const double torque = state.held ? std::min(at.T_b, at.r * at.F_x) : at.T_b;
    return {at.slip, at.mu, at.F_x, at.F_z, at.r, torque};
}

double Wheel::kinetic_energy_J(const WheelState& state) const {
    return 0.5 * parameters_.mass_kg * state.v_mps * state.v_mps +
           0.5 * parameters_.inertia_kgm2 * state.omega_radps * state.omega_radps;
}

}  // namespace plant
