#include "plant_sim/model/wheel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace plant {

PressureArc PressureArc::part(double x0, double x1) const {
    const double w = x1 - x0;
    return {c0 + x0 * (c1 + x0 * (c2 + x0 * c3)), w * (c1 + x0 * (2.0 * c2 + x0 * 3.0 * c3)),
            w * w * (c2 + x0 * 3.0 * c3), w * w * w * c3};
}

namespace {

// ROS3, in the form that needs no product with the Jacobian.
constexpr double kGamma = 0.43586652150845899941601945119356;
constexpr double kGamma2 = 0.24291996454816804366592249683314;
constexpr double kGamma3 = 2.1851380027664058511513169485832;
constexpr double kC21 = -1.0156171083877702091975600115545;
constexpr double kC31 = 4.0759956452537699824805835358067;
constexpr double kC32 = 9.2076794298330791242156818474003;
constexpr double kM2 = 6.1697947043828245592553615689730;
constexpr double kM3 = -0.42772256543218573326238373806514;

}  // namespace

/// The part of the Jacobian that pressure enters, and what the quadratures integrate with its total rates.
struct Wheel::Rates {
    double omega_dot, omega_ddot;
    double a21, t2;  // partial derivatives of omega_dot by v and by time
    double brake_W, tyre_W, friction_mps;
    double brake_rate, tyre_rate, friction_rate;
};

struct Wheel::Sums {
    double distance_m, angle_rad, energy_brake_J, energy_tyre_J, friction_distance_m;
};

Wheel::Wheel(const WheelParameters& parameters, const BrakeTorque& brake, const Surface& surface,
             double tolerance)
    : parameters_(parameters),
      brake_(brake),
      surface_(surface),
      per_mass_(1.0 / parameters.mass_kg),
      per_inertia_(1.0 / parameters.inertia_kgm2),
      per_stiffness_(1.0 / parameters.stiffness_Npm),
      tolerance_(tolerance) {}

inline Wheel::Instant Wheel::instant(double v, double omega, double base_N, double load_slope,
                                     double lift) const {
    Instant at{};
    at.v = v;
    at.omega = omega;
    at.base_N = base_N;
    at.load_slope = load_slope;
    at.lift = lift;
    at.per_v = 1.0 / std::max(v, kSlowest_mps);
    at.F_z = base_N - lift * v * v;
    at.r = parameters_.free_radius_m - at.F_z * per_stiffness_;
    at.slip = (v - omega * at.r) * at.per_v;
    const Friction f = friction(surface_, at.slip);
    at.mu = f.mu;
    at.mu_1 = f.mu_1;
    at.F_x = at.F_z * at.mu;
    const BrakeTorque::Gain gain = brake_.gain(v);
    at.k_b = gain.k_b;
    at.k_b1 = gain.k_b1;
    at.v_dot = -at.F_x * per_mass_;

    const double F_z1 = -2.0 * lift * v;
    const double stiffness = at.F_z * at.mu_1;
    at.r_1 = -F_z1 * per_stiffness_;
    at.slip_v = (1.0 - (v > kSlowest_mps ? at.slip : 0.0) - omega * at.r_1) * at.per_v;
    at.slip_omega = -at.r * at.per_v;
    at.F_v = F_z1 * at.mu + stiffness * at.slip_v;
    at.F_omega = stiffness * at.slip_omega;
    // A load that drifts changes force and radius: both explicit in time.
    at.r_t = -load_slope * per_stiffness_;
    at.slip_t = -omega * at.r_t * at.per_v;
    at.F_t = load_slope * at.mu + stiffness * at.slip_t;
    return at;
}

inline Wheel::Rates Wheel::rates(const Instant& at, double pressure, double pressure_slope) const {
    Rates d{};
    const double T_b = at.k_b * pressure;
    const double T_v = at.k_b1 * pressure;
    const double T_t = at.k_b * pressure_slope;
    d.omega_dot = (at.r * at.F_x - T_b) * per_inertia_;
    d.a21 = (at.r_1 * at.F_x + at.r * at.F_v - T_v) * per_inertia_;
    d.t2 = (at.r_t * at.F_x + at.r * at.F_t - T_t) * per_inertia_;
    d.omega_ddot = d.a21 * at.v_dot + at.r * at.F_omega * per_inertia_ * d.omega_dot + d.t2;

    const double slip_dot = at.slip_v * at.v_dot + at.slip_omega * d.omega_dot + at.slip_t;
    const double F_dot = at.F_v * at.v_dot + at.F_omega * d.omega_dot + at.F_t;
    const double r_dot = at.r_1 * at.v_dot + at.r_t;
    const double sliding = at.v - at.omega * at.r;
    d.brake_W = T_b * at.omega;
    d.tyre_W = at.F_x * sliding;
    d.friction_mps = at.mu * at.v;
    d.brake_rate = (T_v * at.v_dot + T_t) * at.omega + T_b * d.omega_dot;
    d.tyre_rate = F_dot * sliding + at.F_x * (at.v_dot - d.omega_dot * at.r - at.omega * r_dot);
    d.friction_rate = at.mu_1 * slip_dot * at.v + at.mu * at.v_dot;
    return d;
}

inline bool Wheel::same(const Instant& at, const WheelState& state, double base_N, double load_slope,
                        double lift) {
    return state.v_mps == at.v && state.omega_radps == at.omega && base_N == at.base_N &&
           load_slope == at.load_slope && lift == at.lift;
}

inline const Wheel::Instant& Wheel::start_of(const WheelState& state, const LoadArc& load, double x,
                                             double h) {
    const double base_N = load.base_at(x);
    const double load_slope = load.change_N / h;
    Instant& at = instants_[start_];
    if (!same(at, state, base_N, load_slope, load.lift_Ns2pm2))
        at = instant(state.v_mps, state.omega_radps, base_N, load_slope, load.lift_Ns2pm2);
    return at;
}

double Wheel::turn(const Instant& start, const PressureArc& pressure, const LoadArc& load, double h,
                   Instant& end, Sums& sums) const {
    const double per_h = 1.0 / h;
    const double end_Pa = pressure.at(1.0);
    const double end_N = load.base_at(1.0);
    const Rates d0 = rates(start, pressure.at(0.0), pressure.slope(0.0) * per_h);

    const double mid_Pa = pressure.at(kGamma);
    const double mid_N = load.base_at(kGamma);

    // (I / (gamma h) - A) u = rhs, two by two, factored once for the three stages.
    const double diagonal = per_h / kGamma;
    const double a12 = -start.F_omega * per_mass_;
    const double b11 = diagonal + start.F_v * per_mass_;
    const double b22 = diagonal - start.r * start.F_omega * per_inertia_;
    const double inverse = 1.0 / (b11 * b22 - a12 * d0.a21);
    struct Stage {
        double v, omega;
    };
    const auto solve = [&](double x, double y) {
        return Stage{(b22 * x + a12 * y) * inverse, (d0.a21 * x + b11 * y) * inverse};
    };
    const auto derivatives = [&](double v, double omega) {
        const double F_z = mid_N - load.lift_Ns2pm2 * v * v;
        const double r = parameters_.free_radius_m - F_z * per_stiffness_;
        const double slip = (v - omega * r) * (1.0 / std::max(v, kSlowest_mps));
        const double F_x = F_z * friction(surface_, slip).mu;
        return Stage{-F_x * per_mass_, (r * F_x - brake_.gain(v).k_b * mid_Pa) * per_inertia_};
    };

    // The second evaluation serves the third stage too.
    const double t1 = -start.F_t * per_mass_;
    const Stage u1 = solve(start.v_dot + kGamma * h * t1, d0.omega_dot + kGamma * h * d0.t2);
    const Stage f2 = derivatives(start.v + u1.v, start.omega + u1.omega);
    const Stage u2 = solve(f2.v + per_h * kC21 * u1.v + kGamma2 * h * t1,
                           f2.omega + per_h * kC21 * u1.omega + kGamma2 * h * d0.t2);
    const Stage u3 = solve(f2.v + per_h * (kC31 * u1.v + kC32 * u2.v) + kGamma3 * h * t1,
                           f2.omega + per_h * (kC31 * u1.omega + kC32 * u2.omega) + kGamma3 * h * d0.t2);
    end = instant(start.v + u1.v + kM2 * u2.v + kM3 * u3.v,
                  start.omega + u1.omega + kM2 * u2.omega + kM3 * u3.omega, end_N, start.load_slope,
                  load.lift_Ns2pm2);
    const Rates d1 = rates(end, end_Pa, pressure.slope(1.0) * per_h);

    // Quadratures by the trapezoidal rule with its end correction, fourth order, from rates that are known anyway.
    const double half = 0.5 * h;
    const double twelfth = h * h * (1.0 / 12.0);
    const auto integral = [half, twelfth](double g0, double g1, double rate0, double rate1) {
        return half * (g0 + g1) + twelfth * (rate0 - rate1);
    };
    sums.distance_m = integral(start.v, end.v, start.v_dot, end.v_dot);
    sums.angle_rad = integral(start.omega, end.omega, d0.omega_dot, d1.omega_dot);
    sums.energy_brake_J = integral(d0.brake_W, d1.brake_W, d0.brake_rate, d1.brake_rate);
    sums.energy_tyre_J = integral(d0.tyre_W, d1.tyre_W, d0.tyre_rate, d1.tyre_rate);
    sums.friction_distance_m = integral(d0.friction_mps, d1.friction_mps, d0.friction_rate, d1.friction_rate);

    // A wheel that comes to rest and leaves again within the step would turn backwards in between: a cubic dips below its ends by
    // 4/27 of its slopes at the most.
    const double dip = 4.0 / 27.0 * h * (d1.omega_dot - d0.omega_dot);
    if (d0.omega_dot < 0.0 && d1.omega_dot > 0.0 && std::min(start.omega, end.omega) < dip)
        return std::numeric_limits<double>::infinity();
    // The same rule for omega: an error of its end value enters the mismatch times 1 - z/2 + z^2/12, z = h times the pole.
    const double mismatch =
        end.omega - start.omega - integral(d0.omega_dot, d1.omega_dot, d0.omega_ddot, d1.omega_ddot);
    const double z = h * end.r * end.F_omega * per_inertia_;
    const double per_rolling = end.r * end.per_v;
    const double omega_error = mismatch / (1.0 - z * (0.5 - z * (1.0 / 12.0))) * per_rolling;
    // Eq. (8) against eq. (9), of the wheel's energy in free rolling. The two estimates have no blind spot in common.
    const double energy_error =
        0.5 * parameters_.mass_kg * per_inertia_ * (end.v - start.v) * (end.v + start.v) +
        0.5 * (end.omega - start.omega) * (end.omega + start.omega) +
        (sums.energy_brake_J + sums.energy_tyre_J) * per_inertia_;
    return std::max(std::abs(omega_error), std::abs(energy_error) * per_rolling * per_rolling);
}

inline void Wheel::move(WheelState& state, const Instant& end, const Sums& sums) {
    state.v_mps = end.v;
    state.omega_radps = end.omega;
    state.distance_m += sums.distance_m;
    state.angle_rad += sums.angle_rad;
    state.energy_brake_J += sums.energy_brake_J;
    state.energy_tyre_J += sums.energy_tyre_J;
    state.friction_distance_m += sums.friction_distance_m;
    state.held = false;
}

inline bool Wheel::comes_to_rest(const WheelState& state, const Instant& reached) {
    return reached.omega < 0.0 || (reached.omega == 0.0 && state.omega_radps > 0.0);
}

double Wheel::holding_margin_Nm(const WheelState& state, double pressure, const LoadArc& load,
                                double x) const {
    const Instant at = instant(state.v_mps, 0.0, load.base_at(x), 0.0, load.lift_Ns2pm2);
    return at.k_b * pressure - at.r * at.F_x;
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
                   double x1) {
    constexpr int kMostTries = 60;
    constexpr double kAtRest_radps = 1e-9;
    const Instant& start = instants_[start_];
    Instant& end = instants_[1 - start_];
    Sums sums{};
    double lo = x0;
    double hi = x1;
    for (int i = 0; i < kMostTries && hi - lo > 1e-12; ++i) {
        const double x = 0.5 * (lo + hi);
        turn(start, pressure.part(x0, x), load.part(x0, x), (x - x0) * h, end, sums);
        if (std::abs(end.omega) < kAtRest_radps) {
            hi = x;
            break;
        }
        (end.omega > 0.0 ? lo : hi) = x;
    }
    move(state, end, sums);
    // What is left of the wheel's energy is rounding.
    state.omega_radps = 0.0;
    state.held = true;
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

bool Wheel::turns(const WheelState& state, const PressureArc& pressure, const LoadArc& load, double x) const {
    return state.omega_radps > 0.0 || holding_margin_Nm(state, pressure.at(x), load, x) < 0.0;
}

double Wheel::attempt(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h) {
    constexpr double kRefused = 2.0;
    if (!turns(state, pressure, load, 0.0)) {
        WheelState next = state;
        slide(next, load, h);
        if (holding_margin_Nm(next, pressure.at(1.0), load, 1.0) < 0.0) return kRefused;
        state = next;
        state.held = true;
        return 0.0;
    }
    const Instant& start = start_of(state, load, 0.0, h);
    Instant& reached = instants_[1 - start_];
    Sums sums{};
    const double error = turn(start, pressure, load, h, reached, sums);
    if (!(error <= tolerance_) || comes_to_rest(state, reached)) return kRefused;
    move(state, reached, sums);
    start_ = 1 - start_;
    return error / tolerance_;
}

void Wheel::advance(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h) {
    constexpr double kSmallest = 1.0 / 16384.0;
    constexpr double kNoTime = 1e-9;
    constexpr int kMostParts = 4096;  // keeps chatter between turning and held finite
    double x = 0.0;
    double part = 1.0;
    for (int i = 0; i < kMostParts && 1.0 - x > kNoTime && state.v_mps > kSlowest_mps; ++i) {
        if (!turns(state, pressure, load, x)) {
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
        const Instant& start = start_of(state, load, x, h);
        Instant& reached = instants_[1 - start_];
        Sums sums{};
        const double error =
            whole ? turn(start, pressure, load, h, reached, sums)
                  : turn(start, pressure.part(x, end), load.part(x, end), (end - x) * h, reached, sums);
        if (!(error <= tolerance_) && part > kSmallest) {
            part *= 0.5;
            continue;
        }
        if (comes_to_rest(state, reached)) {
            x = lock(state, pressure, load, h, x, end);
            part = 1.0;
            continue;
        }
        move(state, reached, sums);
        start_ = 1 - start_;
        x = end;
        if (error < 0.125 * tolerance_) part = std::min(2.0 * part, 1.0);
    }
}

Forces Wheel::forces(const WheelState& state, double pressure_Pa, const LoadArc& load) const {
    const auto forces_at = [&](const Instant& at) {
        const double T_b = at.k_b * std::max(pressure_Pa, 0.0);
        return Forces{at.slip, at.mu, at.F_x, at.F_z, at.r, state.held ? std::min(T_b, at.r * at.F_x) : T_b};
    };
    const Instant& last = instants_[start_];
    if (same(last, state, load.base_N, load.change_N, load.lift_Ns2pm2)) return forces_at(last);
    return forces_at(instant(state.v_mps, state.omega_radps, load.base_N, load.change_N, load.lift_Ns2pm2));
}

double Wheel::kinetic_energy_J(const WheelState& state) const {
    return 0.5 * parameters_.mass_kg * state.v_mps * state.v_mps +
           0.5 * parameters_.inertia_kgm2 * state.omega_radps * state.omega_radps;
}

}  // namespace plant
