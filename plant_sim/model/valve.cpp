#include "plant_sim/model/valve.hpp"

#include <cmath>
#include <stdexcept>
#include <unsupported/Eigen/MatrixFunctions>

namespace plant {

namespace {

/// Adds the brake's row of the matrix exponential; pressure, rate, brake, input and its slope are one system.
void add_line(const rig::ValveParameters& parameters, double h, ValveDynamics::Transition& t) {
    const double w = parameters.natural_frequency_radps;
    const double per_line = 1.0 / parameters.line_s;
    Eigen::Matrix<double, 5, 5> system = Eigen::Matrix<double, 5, 5>::Zero();
    system(0, 1) = 1.0;
    system.row(1) << -w * w, -2.0 * parameters.damping * w, 0.0, w * w, 0.0;
    system.row(2) << per_line, 0.0, -per_line, 0.0, 0.0;
    system(3, 4) = 1.0;
    const Eigen::Matrix<double, 5, 5> over_h = (system * h).exp();
    t.per_line = per_line;
    t.bp = over_h(2, 0);
    t.br = over_h(2, 1);
    t.bb = over_h(2, 2);
    t.bu1 = over_h(2, 4) / h;
    t.bu0 = over_h(2, 3) - t.bu1;
}

}  // namespace

ValveDynamics::Transition ValveDynamics::transition(const rig::ValveParameters& parameters, double h) {
    // Underdamped second order: homogeneous part by the matrix exponential, the ramp u0 + (u1 - u0) t / h by
    // its particular solution p = u(t) - (2 xi / omega_n) u', rate = u'.
    const double w = parameters.natural_frequency_radps;
    const double decay = parameters.damping * w;
    const double wd = w * std::sqrt(1.0 - parameters.damping * parameters.damping);
    const double e = std::exp(-decay * h);
    const double c = e * std::cos(wd * h);
    const double s = e * std::sin(wd * h) / wd;
    const double f_pp = c + decay * s, f_pr = s, f_rp = -w * w * s, f_rr = c - decay * s;
    const double lag = 2.0 * parameters.damping / w / h;  // times (u1 - u0)
    // x(h) = F (x(0) - xp(0)) + xp(h), with xp(0) = (u0 - lag du, du / h), xp(h) = (u1 - lag du, du / h).
    Transition t{};
    t.pp = f_pp;
    t.pr = f_pr;
    t.pu0 = -f_pp * (1.0 + lag) + f_pr / h + lag;
    t.pu1 = f_pp * lag - f_pr / h + 1.0 - lag;
    t.rp = f_rp;
    t.rr = f_rr;
    t.ru0 = -f_rp * (1.0 + lag) + f_rr / h - 1.0 / h;
    t.ru1 = f_rp * lag - f_rr / h + 1.0 / h;
    if (parameters.line_s > 0.0) add_line(parameters, h, t);
    return t;
}

Valve::Valve(const rig::ValveParameters& parameters, double step_s) : step_s_(step_s) {
    if (!(parameters.damping > 0.0 && parameters.damping < 1.0)) throw std::invalid_argument("valve damping must lie between 0 and 1");
    if (!(parameters.line_s >= 0.0)) throw std::invalid_argument("a valve's line has no lag below zero");
    // Splits the delay into whole steps and a rest: a command given at a step's start acts `first_s_` after the start of a later step.
    constexpr double kRounding = 1e-9;
    const double steps = parameters.delay_s / step_s;
    double whole = std::floor(steps + kRounding);
    double rest = steps - whole;
    if (rest < kRounding) rest = 0.0;
    first_s_ = rest * step_s;
    second_s_ = step_s - first_s_;
    if (first_s_ > 0.0) first_ = ValveDynamics::transition(parameters, first_s_);
    second_ = ValveDynamics::transition(parameters, second_s_);
    delay_line_.assign(static_cast<std::size_t>(whole) + 2, {0.0, 0.0});
}

PressureArc ValveDynamics::advance(const Transition& t, double u0, double u1, double h) {
    const double p = t.pp * pressure_ + t.pr * rate_ + t.pu0 * u0 + t.pu1 * u1;
    const double r = t.rp * pressure_ + t.rr * rate_ + t.ru0 * u0 + t.ru1 * u1;
    const double b = t.per_line == 0.0 ? p : t.bb * brake_ + t.bp * pressure_ + t.br * rate_ + t.bu0 * u0 + t.bu1 * u1;
    const PressureArc arc = t.per_line == 0.0 ? PressureArc::hermite(pressure_, rate_, p, r, h)
                                              : PressureArc::hermite(brake_, (pressure_ - brake_) * t.per_line, b, (p - b) * t.per_line, h);
    pressure_ = p;
    rate_ = r;
    brake_ = b;
    return arc;
}

Valve::Arcs Valve::advance(double start_Pa, double end_Pa) {
    const std::size_t size = delay_line_.size();
    delay_line_[next_] = {start_Pa, end_Pa};
    // With n whole steps of delay the newest entry acts n calls later; the entry before it acts in the first part of the step.
    const Ramp& acting = delay_line_[(next_ + 2) % size];
    const Ramp& before = delay_line_[(next_ + 1) % size];
    next_ = (next_ + 1) % size;
    Arcs arcs{};
    if (first_s_ > 0.0) {
        const double cut = before.start_Pa + (before.end_Pa - before.start_Pa) * second_s_ / step_s_;
        arcs.first = dynamics_.advance(first_, cut, before.end_Pa, first_s_);
    }
    const double cut = acting.start_Pa + (acting.end_Pa - acting.start_Pa) * second_s_ / step_s_;
    arcs.second = dynamics_.advance(second_, acting.start_Pa, cut, second_s_);
    return arcs;
}

}  // namespace plant
