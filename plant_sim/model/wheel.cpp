#include "plant_sim/model/wheel.hpp"

#include <algorithm>
#include <cmath>

namespace plant {

PressureArc PressureArc::part(double x0, double x1) const {
    const double w = x1 - x0;
    return {c0 + x0 * (c1 + x0 * (c2 + x0 * c3)), w * (c1 + x0 * (2.0 * c2 + x0 * 3.0 * c3)), w * w * (c2 + x0 * 3.0 * c3), w * w * w * c3};
}

Wheel::Wheel(const rig::WheelParameters& parameters, const BrakeTorque& brake, const rig::Surface& surface, double tolerance)
    : parameters_(parameters),
      law_{.mass_kg = parameters.mass_kg,
           .per_mass = 1.0 / parameters.mass_kg,
           .per_inertia = 1.0 / parameters.inertia_kgm2,
           .per_stiffness = 1.0 / parameters.stiffness_Npm,
           .free_radius_m = parameters.free_radius_m,
           .tyre = surface.law(),
           .brake = brake},
      tolerance_(tolerance) {}

inline bool Wheel::same(const Instant& at, const WheelState& state, double base_N, double load_slope, double lift) {
    return state.v_mps == at.v && state.omega_radps == at.omega && base_N == at.base_N && load_slope == at.load_slope && lift == at.lift;
}

const Wheel::Instant& Wheel::start_of(const WheelState& state, const LoadArc& load, double x, double h) {
    const double base_N = load.base_at(x);
    const double load_slope = load.change_N / h;
    if (!same(last_, state, base_N, load_slope, load.lift_Ns2pm2)) {
        last_ = wheel_step::instant(law_, state.v_mps, state.omega_radps, base_N, load_slope, load.lift_Ns2pm2);
    }
    return last_;
}

Wheel::Step Wheel::turn(const Instant& start, const PressureArc& pressure, const LoadArc& load, double h) const {
    return wheel_step::turn(law_, start, pressure, load, h);
}

inline void Wheel::move(WheelState& state, const Step& step) {
    state.v_mps = step.end.v;
    state.omega_radps = step.end.omega;
    state.distance_m += step.sums.distance_m;
    state.angle_rad += step.sums.angle_rad;
    state.energy_brake_J += step.sums.energy_brake_J;
    state.energy_tyre_J += step.sums.energy_tyre_J;
    state.friction_distance_m += step.sums.friction_distance_m;
    state.held = false;
    last_ = step.end;
}

inline bool Wheel::comes_to_rest(const WheelState& state, const Instant& reached) {
    return reached.omega < 0.0 || (reached.omega == 0.0 && state.omega_radps > 0.0);
}

double Wheel::holding_margin_Nm(const WheelState& state, double pressure, const LoadArc& load, double x) const {
    const Instant at = wheel_step::instant(law_, state.v_mps, 0.0, load.base_at(x), 0.0, load.lift_Ns2pm2);
    return at.k_b * pressure - at.r * at.F_x;
}

void Wheel::slide(WheelState& state, const LoadArc& load, double h) const {
    // Slip is 1 and mu constant, so that v_dot depends only on F_z(v), weakly. Classic fourth-order Runge-Kutta is exact to rounding.
    const double mu = rig::friction(law_.tyre, 1.0).mu;
    const auto v_dot = [&](double v, double x) { return -mu * load.force_N(x, v) * law_.per_mass; };
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

double Wheel::lock(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h, double x0, double x1) {
    constexpr int kMaxTries = 60;
    constexpr double kAtRest_radps = 1e-9;
    const Instant start = last_;
    Step step{};
    double lo = x0;
    double hi = x1;
    for (int i = 0; i < kMaxTries && hi - lo > 1e-12; ++i) {
        const double x = 0.5 * (lo + hi);
        step = turn(start, pressure.part(x0, x), load.part(x0, x), (x - x0) * h);
        if (std::abs(step.end.omega) < kAtRest_radps) {
            hi = x;
            break;
        }
        (step.end.omega > 0.0 ? lo : hi) = x;
    }
    move(state, step);
    // The remaining energy of the wheel is a rounding error.
    state.omega_radps = 0.0;
    state.held = true;
    return hi;
}

double Wheel::release(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h, double x0) const {
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
    constexpr double kRejected = 2.0;
    if (!turns(state, pressure, load, 0.0)) {
        WheelState next = state;
        slide(next, load, h);
        if (holding_margin_Nm(next, pressure.at(1.0), load, 1.0) < 0.0) return kRejected;
        state = next;
        state.held = true;
        return 0.0;
    }
    const Instant& start = start_of(state, load, 0.0, h);
    const Step step = turn(start, pressure, load, h);
    if (!(step.error <= tolerance_) || comes_to_rest(state, step.end)) return kRejected;
    move(state, step);
    return step.error / tolerance_;
}

bool Wheel::take(WheelState& state, const Step& step) {
    const bool turns_on = state.v_mps > kSlowest_mps && state.omega_radps > 0.0 && step.end.omega > 0.0;
    if (!turns_on || !(step.error <= tolerance_)) return false;
    move(state, step);
    return true;
}

void Wheel::advance(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h) {
    constexpr double kSmallest = 1.0 / 16384.0;
    constexpr double kNoTime = 1e-9;
    constexpr int kMaxParts = 4096;  // limits the alternation between turning and held
    double x = 0.0;
    double part = 1.0;
    for (int i = 0; i < kMaxParts && 1.0 - x > kNoTime && state.v_mps > kSlowest_mps; ++i) {
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
        const Step step = whole ? turn(start, pressure, load, h) : turn(start, pressure.part(x, end), load.part(x, end), (end - x) * h);
        if (!(step.error <= tolerance_) && part > kSmallest) {
            part *= 0.5;
            continue;
        }
        if (comes_to_rest(state, step.end)) {
            x = lock(state, pressure, load, h, x, end);
            part = 1.0;
            continue;
        }
        move(state, step);
        x = end;
        if (step.error < 0.125 * tolerance_) part = std::min(2.0 * part, 1.0);
    }
}

Forces Wheel::forces(const WheelState& state, double pressure_Pa, const LoadArc& load) const {
    const auto forces_at = [&](const Instant& at) {
        const double T_b = at.k_b * std::max(pressure_Pa, 0.0);
        return Forces{at.slip, at.mu, at.F_x, at.F_z, at.r, state.held ? std::min(T_b, at.r * at.F_x) : T_b};
    };
    if (same(last_, state, load.base_N, load.change_N, load.lift_Ns2pm2)) return forces_at(last_);
    return forces_at(wheel_step::instant(law_, state.v_mps, state.omega_radps, load.base_N, load.change_N, load.lift_Ns2pm2));
}

double Wheel::kinetic_energy_J(const WheelState& state) const {
    return 0.5 * parameters_.mass_kg * state.v_mps * state.v_mps + 0.5 * parameters_.inertia_kgm2 * state.omega_radps * state.omega_radps;
}

}  // namespace plant
