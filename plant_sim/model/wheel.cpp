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
    double v, omega, pressure;
    double F_z, r, slip, mu, mu_1, F_x, k_b, k_b1, T_b;
    double v_dot, omega_dot;
};

/// Partial derivatives of (v_dot, omega_dot) and of the two powers, and total rates of the powers.
struct Wheel::Rates {
    double a11, a12, a21, a22;  // Jacobian
    double t1, t2;              // explicit time derivative per unit of x
    double brake_W, tyre_W, friction_mps;
    double brake_rate, tyre_rate, friction_rate, v_ddot, omega_ddot;  // total, per second
};

Wheel::Wheel(const WheelParameters& parameters, const BrakeTorque& brake, const Surface& surface)
    : parameters_(parameters), brake_(brake), surface_(surface) {}

Wheel::Local Wheel::local(double v, double omega, double pressure, const LoadArc& load, double x) const {
    Local at{};
    at.v = std::max(v, kSlowest_mps);
    at.omega = omega;
    at.pressure = pressure;
    at.F_z = load.force_N(x, at.v);
    at.r = parameters_.free_radius_m - at.F_z / parameters_.stiffness_Npm;
    at.slip = 1.0 - omega * at.r / at.v;
    const Friction f = friction(surface_, at.slip);
    at.mu = f.mu;
    at.mu_1 = f.mu_1;
    at.F_x = at.F_z * at.mu;
    const BrakeTorque::Gain gain = brake_.gain(at.v);
    at.k_b = gain.k_b;
    at.k_b1 = gain.k_b1;
    at.T_b = at.k_b * pressure;
    at.v_dot = -at.F_x / parameters_.mass_kg;
    at.omega_dot = (at.r * at.F_x - at.T_b) / parameters_.inertia_kgm2;
    return at;
}

Wheel::Rates Wheel::rates(const Local& at, double pressure_slope, const LoadArc& load, double h) const {
    const double m = parameters_.mass_kg;
    const double J = parameters_.inertia_kgm2;
    const double load_slope = load.change_N / h;
    const double F_z1 = -2.0 * load.lift_Ns2pm2 * at.v;
    const double r_1 = -F_z1 / parameters_.stiffness_Npm;
    const double per_v = 1.0 / at.v;
    const double slip_v = (1.0 - at.slip) * per_v - at.omega * r_1 * per_v;
    const double slip_omega = -at.r * per_v;
    const double F_v = F_z1 * at.mu + at.F_z * at.mu_1 * slip_v;
    const double F_omega = at.F_z * at.mu_1 * slip_omega;

    // A load that drifts changes force and radius: both explicit in time.
    const double r_t = -load_slope / parameters_.stiffness_Npm;
    const double slip_t = -at.omega * r_t * per_v;
    const double F_t = load_slope * at.mu + at.F_z * at.mu_1 * slip_t;
    const double T_t = at.k_b * pressure_slope;

    Rates d{};
    d.a11 = -F_v / m;
    d.a12 = -F_omega / m;
    d.a21 = (r_1 * at.F_x + at.r * F_v - at.k_b1 * at.pressure) / J;
    d.a22 = at.r * F_omega / J;
    d.t1 = -F_t / m;
    d.t2 = (r_t * at.F_x + at.r * F_t - T_t) / J;

    const double F_dot = F_v * at.v_dot + F_omega * at.omega_dot + F_t;
    const double r_dot = r_1 * at.v_dot + r_t;
    const double T_dot = at.k_b1 * at.v_dot * at.pressure + T_t;
    const double sliding = at.v - at.omega * at.r;
    d.v_ddot = -F_dot / m;
    d.omega_ddot = (r_dot * at.F_x + at.r * F_dot - T_dot) / J;
    d.brake_W = at.T_b * at.omega;
    d.tyre_W = at.F_x * sliding;
    d.friction_mps = at.mu * at.v;
    d.brake_rate = T_dot * at.omega + at.T_b * at.omega_dot;
    d.tyre_rate = F_dot * sliding + at.F_x * (at.v_dot - at.omega_dot * at.r - at.omega * r_dot);
    d.friction_rate =
        at.mu_1 * (slip_v * at.v_dot + slip_omega * at.omega_dot + slip_t) * at.v + at.mu * at.v_dot;
    return d;
}

void Wheel::free_step(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h) const {
    constexpr double kGamma = 0.5;
    const Local start = local(state.v_mps, state.omega_radps, pressure.at(0.0), load, 0.0);
    const Rates d0 = rates(start, pressure.slope(0.0) / h, load, h);

    // (I / (gamma h) - A) u = rhs, two by two, factored once for the four stages.
    const double diagonal = 1.0 / (kGamma * h);
    const double b11 = diagonal - d0.a11;
    const double b22 = diagonal - d0.a22;
    const double inverse = 1.0 / (b11 * b22 - d0.a12 * d0.a21);
    const auto solve = [&](double x, double y, double& u, double& w) {
        u = (b22 * x + d0.a12 * y) * inverse;
        w = (d0.a21 * x + b11 * y) * inverse;
    };
    const double per_h = 1.0 / h;

    double u1v, u1w, u2v, u2w, u3v, u3w, u4v, u4w;
    solve(start.v_dot + 0.5 * h * d0.t1, start.omega_dot + 0.5 * h * d0.t2, u1v, u1w);
    solve(start.v_dot + 4.0 * per_h * u1v + 1.5 * h * d0.t1,
          start.omega_dot + 4.0 * per_h * u1w + 1.5 * h * d0.t2, u2v, u2w);
    const double pressure_end = pressure.at(1.0);
    const Local third =
        local(state.v_mps + 2.0 * u1v, state.omega_radps + 2.0 * u1w, pressure_end, load, 1.0);
    solve(third.v_dot + per_h * (u1v - u2v), third.omega_dot + per_h * (u1w - u2w), u3v, u3w);
    const Local fourth =
        local(state.v_mps + 2.0 * u1v + u3v, state.omega_radps + 2.0 * u1w + u3w, pressure_end, load, 1.0);
    solve(fourth.v_dot + per_h * (u1v - u2v - 8.0 / 3.0 * u3v),
          fourth.omega_dot + per_h * (u1w - u2w - 8.0 / 3.0 * u3w), u4v, u4w);

    const double v = state.v_mps + 2.0 * u1v + u3v + u4v;
    const double omega = state.omega_radps + 2.0 * u1w + u3w + u4w;

    // Quadratures by the trapezoidal rule with its end correction, fourth order, from rates that are known
    // anyway.
    const Local end = local(v, omega, pressure_end, load, 1.0);
    const Rates d1 = rates(end, pressure.slope(1.0) / h, load, h);
    const auto integral = [h](double g0, double g1, double rate0, double rate1) {
        return 0.5 * h * (g0 + g1) + h * h / 12.0 * (rate0 - rate1);
    };
    state.distance_m += integral(start.v, end.v, start.v_dot, end.v_dot);
    state.angle_rad += integral(start.omega, end.omega, start.omega_dot, end.omega_dot);
    state.energy_brake_J += integral(d0.brake_W, d1.brake_W, d0.brake_rate, d1.brake_rate);
    state.energy_tyre_J += integral(d0.tyre_W, d1.tyre_W, d0.tyre_rate, d1.tyre_rate);
    state.friction_distance_m +=
        integral(d0.friction_mps, d1.friction_mps, d0.friction_rate, d1.friction_rate);
    state.v_mps = v;
    state.omega_radps = omega;
}

/// Torque by which the brake exceeds what the tyre can turn: above zero a wheel at rest stays at rest.
double Wheel::holding_margin_Nm(const WheelState& state, double pressure, const LoadArc& load,
                                double x) const {
    const Local at = local(state.v_mps, 0.0, pressure, load, x);
    return at.T_b - at.r * at.F_x;
}

void Wheel::held_step(WheelState& state, const LoadArc& load, double h) const {
    // Slip is 1 and mu constant: v_dot depends on F_z(v) alone, mildly. Classic fourth-order Runge-Kutta is
    // exact to rounding.
    const double mu = friction(surface_, 1.0).mu;
    const auto decel = [&](double v, double x) { return -mu * load.force_N(x, v) / parameters_.mass_kg; };
    const double v0 = state.v_mps;
    const double k1 = decel(v0, 0.0);
    const double k2 = decel(v0 + 0.5 * h * k1, 0.5);
    const double k3 = decel(v0 + 0.5 * h * k2, 0.5);
    const double k4 = decel(v0 + h * k3, 1.0);
    const double v1 = std::max(v0 + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4), 0.0);
    const double metres = 0.5 * h * (v0 + v1) + h * h / 12.0 * (k1 - k4);
    state.v_mps = v1;
    state.distance_m += metres;
    state.friction_distance_m += mu * metres;
    // All of the kinetic energy lost goes into the sliding tyre: F_x v dt = -m v dv.
    state.energy_tyre_J += 0.5 * parameters_.mass_kg * (v0 * v0 - v1 * v1);
}

void Wheel::advance(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h) const {
    // A step holds at most a few changes between turning and held; the bound keeps chatter at the boundary
    // finite.
    constexpr int kMostChanges = 8;
    constexpr double kNoTime = 1e-9;
    if (state.v_mps <= kSlowest_mps) return;
    double x = 0.0;
    for (int change = 0; change < kMostChanges && 1.0 - x > kNoTime; ++change) {
        const PressureArc arc = pressure.part(x, 1.0);
        const LoadArc part = load.part(x, 1.0);
        const double rest = (1.0 - x) * h;
        const bool turns = state.omega_radps > 0.0;
        if (turns || holding_margin_Nm(state, arc.at(0.0), part, 0.0) < 0.0) {
            state.held = false;
            WheelState next = state;
            free_step(next, arc, part, rest);
            if (next.omega_radps > 0.0) {
                state = next;
                return;
            }
            // The wheel locks inside: find when by secant on the fraction, then hold from there.
            double lo = 0.0, hi = 1.0, omega_lo = state.omega_radps, omega_hi = next.omega_radps;
            double fraction = 1.0;
            for (int i = 0; i < 30 && hi - lo > 1e-12; ++i) {
                const double secant = lo + (hi - lo) * omega_lo / (omega_lo - omega_hi);
                fraction = std::clamp(secant, lo + 0.01 * (hi - lo), hi - 0.01 * (hi - lo));
                next = state;
                free_step(next, arc.part(0.0, fraction), part.part(0.0, fraction), fraction * rest);
                if (std::abs(next.omega_radps) < 1e-9) break;
                (next.omega_radps > 0.0 ? lo : hi) = fraction;
                (next.omega_radps > 0.0 ? omega_lo : omega_hi) = next.omega_radps;
            }
            next.omega_radps = 0.0;
            next.held = true;
            state = next;
            x += fraction * (1.0 - x);
            continue;
        }
        state.held = true;
        WheelState next = state;
        held_step(next, part, rest);
        if (holding_margin_Nm(next, arc.at(1.0), part, 1.0) >= 0.0) {
            state = next;
            return;
        }
        // The tyre wins inside the step: bisect for the moment of release.
        double lo = 0.0, hi = 1.0;
        while (hi - lo > 1e-9) {
            const double middle = 0.5 * (lo + hi);
            next = state;
            held_step(next, part.part(0.0, middle), middle * rest);
            const double margin = holding_margin_Nm(next, arc.at(middle), part, middle);
            (margin >= 0.0 ? lo : hi) = middle;
        }
        next = state;
        held_step(next, part.part(0.0, hi), hi * rest);
        state = next;
        x += hi * (1.0 - x);
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
