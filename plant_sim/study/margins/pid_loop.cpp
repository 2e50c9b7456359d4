#include "plant_sim/study/margins/pid_loop.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "plant_sim/study/margins/linear_wheel.hpp"

namespace study::margins {

namespace {

/// Roots of a s^2 + b s + c; fewer where leading coefficients are zero.
std::vector<Complex> roots(double a, double b, double c) {
    if (a == 0.0) {
        if (b == 0.0) return {};
        return {Complex(-c / b)};
    }
    const Complex d = std::sqrt(Complex(b * b - 4.0 * a * c));
    if (d.imag() != 0.0) return {(-b + d) / (2.0 * a), (-b - d) / (2.0 * a)};
    // The root of larger magnitude first; the other from their product, without cancellation.
    const double q = -0.5 * (b + std::copysign(d.real(), b));
    if (q == 0.0) return {Complex(0.0), Complex(0.0)};
    return {Complex(q / a), Complex(c / q)};
}

/// Of valve and line.
std::vector<Complex> valve_poles(const rig::ValveParameters& valve) {
    const double w = valve.natural_frequency_radps;
    std::vector<Complex> poles = roots(1.0, 2.0 * valve.damping * w, w * w);
    if (valve.line_s > 0.0) poles.emplace_back(-1.0 / valve.line_s);
    return poles;
}

/// Transfer function from the brake's slip rate to slip: gain prod(s - z) / prod(s - p).
struct Wheel {
    double gain;
    std::vector<Complex> zeros, poles;
};

Wheel wheel_at(const OperatingPoint& at, Linearisation linearisation) {
    const LinearWheel w = linear_wheel(at, linearisation);
    return {w.gain, w.zeros(), w.poles()};
}

DelayLoop make(const Pid& pid, const rig::ValveParameters& valve, Wheel wheel, double factor) {
    if (pid.k_d != 0.0 && !(pid.filter_s > 0.0)) throw std::invalid_argument("a derivative needs a filter time above zero");
    const double w = valve.natural_frequency_radps;
    std::vector<Complex> poles = std::move(wheel.poles), zeros = std::move(wheel.zeros);
    const std::vector<Complex> lag = valve_poles(valve);
    poles.insert(poles.begin(), lag.begin(), lag.end());
    double gain = factor * w * w * wheel.gain;
    if (valve.line_s > 0.0) gain /= valve.line_s;
    // C(s) = (k_p s (1 + s T) + k_i (1 + s T) + k_d s^2) / (s (1 + s T))
    const double t = pid.k_d != 0.0 ? pid.filter_s : 0.0;
    double c2 = pid.k_p_per_s * t + pid.k_d, c1 = pid.k_p_per_s + pid.k_i_per_s2 * t, c0 = pid.k_i_per_s2;
    if (t > 0.0) {
        poles.emplace_back(-1.0 / t);
        gain /= t;
    }
    if (c0 != 0.0) {
        poles.emplace_back(0.0);
    } else {
        c0 = c1, c1 = c2, c2 = 0.0;
    }
    double leading = c2;
    if (leading == 0.0) leading = c1;
    if (leading == 0.0) leading = c0;
    const std::vector<Complex> controller = roots(c2, c1, c0);
    zeros.insert(zeros.begin(), controller.begin(), controller.end());
    return {gain * leading, std::move(zeros), std::move(poles), valve.delay_s};
}

}  // namespace

DelayLoop pid_loop(const Pid& pid, const rig::ValveParameters& valve, const OperatingPoint& at, Linearisation linearisation) {
    return make(pid, valve, wheel_at(at, linearisation), std::pow(at.speed_mps / Pid::kScheduleSpeed_mps, pid.schedule - 1.0));
}

DelayLoop pid_loop(const Pid& pid, const rig::ValveParameters& valve, double wheel_pole_radps) {
    return make(pid, valve, {1.0, {}, {-wheel_pole_radps}}, 1.0);
}

DelayLoop plant_loop(const rig::ValveParameters& valve, const OperatingPoint& at, Linearisation linearisation) {
    const double per_MPa = 1e6 * at.brake_gain_m3 * at.radius_m / (at.inertia_kgm2 * at.speed_mps);
    return make({.k_p_per_s = 1.0}, valve, wheel_at(at, linearisation), per_MPa);
}

}  // namespace study::margins
