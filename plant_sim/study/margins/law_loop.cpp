#include "plant_sim/study/margins/law_loop.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "firmware/control/config.hpp"
#include "plant_sim/model/rig.hpp"
#include "plant_sim/study/margins/dense.hpp"
#include "plant_sim/study/margins/linear_wheel.hpp"

namespace study::margins {

namespace {

/// One period: pressure at the brake; at the valve, if there is a line; the latter's rate; the wheel's state of linear_wheel.hpp, the integral of the
/// rim's slip since the beginning of the period.
struct SampledPlant {
    Eigen::MatrixXd phi;
    Eigen::VectorXd old_input, new_input;  ///< of the command before and after the broken part of the delay
};

/// dP/di of a polyline at pressure `p`.
double slope(const std::vector<rig::PressureMap::Point>& points, double p) {
    std::size_t i = 1;
    while (i + 1 < points.size() && points[i].pressure_Pa < p) ++i;
    return (points[i].pressure_Pa - points[i - 1].pressure_Pa) / (points[i].current_mA - points[i - 1].current_mA);
}

/// Number of states of valve and line.
Eigen::Index pressure_states(const rig::ValveParameters& valve) {
    return valve.line_s > 0.0 ? 3 : 2;
}

/// `per_pressure`: q of `wheel` per unit of pressure; `per_command`: pressure per unit of command; `broken_s`: the fractional part of the delay.
SampledPlant sampled_plant(const rig::ValveParameters& valve, const LinearWheel& wheel, double per_pressure, double per_command, double period_s,
                           double broken_s) {
    const Eigen::Index rim = pressure_states(valve), rate = rim - 1, at_valve = rim - 2;
    const Eigen::Index n = wheel.a.rows(), integral = rim + n, input = integral + 1;
    const double w = valve.natural_frequency_radps;
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(input + 1, input + 1);
    if (valve.line_s > 0.0) {
        a(0, 0) = -1.0 / valve.line_s;
        a(0, at_valve) = 1.0 / valve.line_s;
    }
    a(at_valve, rate) = 1.0;
    a(rate, at_valve) = -w * w;
    a(rate, rate) = -2.0 * valve.damping * w;
    a(rate, input) = w * w * per_command;
    a(rim, 0) = per_pressure * wheel.gain;
    a.block(rim, rim, n, n) = wheel.a;
    a(integral, rim) = 1.0;
    const Eigen::MatrixXd first = exponential(a * broken_s);
    const Eigen::MatrixXd second = exponential(a * (period_s - broken_s));
    return {second.topLeftCorner(input, input) * first.topLeftCorner(input, input),
            second.topLeftCorner(input, input) * first.topRightCorner(input, 1), second.topRightCorner(input, 1)};
}

/// Gain of the plant's valve over the controller's, at a pressure.
double valve_gain(const antiskid::control::ValveConfig& believed, const rig::PressureMap& map, double pressure_Pa) {
    std::vector<rig::PressureMap::Point> points;
    points.reserve(believed.points);
    for (std::size_t i = 0; i < believed.points; ++i)
        points.push_back({static_cast<double>(believed.current_mA[i]), static_cast<double>(believed.pressure_Pa[i])});
    return slope(map.points(), pressure_Pa) / slope(points, pressure_Pa);
}

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double kPi = std::numbers::pi;
constexpr double kSpeedNoise = 1.0, kClockNoise_radps = 0.02;  // as in wheel_observer.cpp

/// The lag of eq. (6) over `h` with a held input: state (p, p'), unit static gain.
struct Lag {
    Matrix2d phi;
    Vector2d gamma;
};

Lag lag(double omega_n, double xi, double h) {
    Matrix2d a;
    a << 0.0, 1.0, -omega_n * omega_n, -2.0 * xi * omega_n;
    const Matrix2d phi = exponential(a * h);
    return {phi, {1.0 - phi(0, 0), -phi(1, 0)}};
}

std::size_t whole_periods(double delay_s, double period_s) {
    return static_cast<std::size_t>(std::floor(delay_s / period_s + 1e-3));
}

/// One period of controller and plant, step by step as their code does it, in units of slip: pressure as the slip rate that it causes
/// by the controller's numbers, q = (r k_b / (J v_late)) P; wheel speed as slip, -(r / v_late) omega.
class Period {
  public:
    Period(const antiskid::control::Config& config, const rig::RigParameters& rig, const OperatingPoint& at, Linearisation linearisation,
           std::optional<double> wheel_pole_radps)
        : law_(config.slip), h_(static_cast<double>(config.period_s)) {
        const auto& valve = config.valve;
        const double delay = static_cast<double>(valve.delay_s);
        whole_ = whole_periods(delay, h_);
        part_ = std::max(delay / h_ - static_cast<double>(whole_), 0.0);
        if (part_ < 1e-3) part_ = 0.0;
        model_ = lag(static_cast<double>(valve.natural_frequency_radps), static_cast<double>(valve.damping), h_);
        const double l = static_cast<double>(config.estimator.pressure_bandwidth_radps);
        correct_p_ = l * h_ / (1.0 + l * h_);
        correct_r_ = 0.5 * l * correct_p_;
        correct_offset_ = static_cast<double>(config.estimator.valve_offset_radps) * h_;

        const double edge_s = 2.0 * kPi * at.radius_m / (rig.wheel_encoder.teeth * (1.0 - at.slip) * at.speed_mps);
        reading_every_ = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(edge_s / h_)));
        edge_age_ = reading_every_ == 1 ? std::min(edge_s / h_, 1.0) / 2.0 : 0.5;
        const double interval = static_cast<double>(reading_every_) * h_;
        reading_age_ = 0.5 * (interval + h_);
        pole_ = wheel_pole_radps.value_or(at.wheel_pole_radps(linearisation));
        believed_ = pole_ > 0.0 ? static_cast<double>(config.observer.prediction_share) * pole_ : pole_;
        gain_ = static_cast<double>(law_.k_p_per_s) + static_cast<double>(law_.k_pole) * std::max(pole_, 0.0);
        correct_ = steady_gains(config, interval);
        deceleration_per_s_ = at.deceleration_mps2 / at.speed_mps;

        const double believed = static_cast<double>(config.wheel.brake_gain_m3) / static_cast<double>(config.wheel.inertia_kgm2);
        const double true_per_believed = at.brake_gain_m3 / at.inertia_kgm2 / believed;
        pipe_ = whole_periods(rig.valve.delay_s, h_);
        const double broken = std::max(rig.valve.delay_s - static_cast<double>(pipe_) * h_, 0.0);
        const LinearWheel wheel = linear_wheel(at, linearisation);
        motion_states_ = pressure_states(rig.valve) + wheel.a.rows();
        plant_ = sampled_plant(rig.valve, wheel, true_per_believed, valve_gain(valve, rig.pressure_map, at.pressure_Pa), h_, broken);
    }

    // The state, in this order: commands in the controller's pipe, its valve state, tracker, integral, valve offset; commands in the
    // valve's pipe, valve state and wheel, mean slip of the rim over the last periods, newest first.
    [[nodiscard]] Index size() const { return means_at() + static_cast<Index>(reading_every_) + 1; }
    [[nodiscard]] std::size_t reading_every() const { return reading_every_; }
    [[nodiscard]] Index controller_states() const { return plant_at(); }

    /// The command that this period's step gives; `x` moves on with `w` acting on the valve.
    double step(VectorXd& x, double w, bool new_reading) const {
        const double u = control(x, new_reading);
        move(x, w);
        return u;
    }

  private:
    [[nodiscard]] Index valve_at() const { return static_cast<Index>(whole_) + 2; }
    [[nodiscard]] Index plant_at() const { return valve_at() + 6; }
    [[nodiscard]] Index motion_at() const { return plant_at() + static_cast<Index>(pipe_) + 2; }
    [[nodiscard]] Index means_at() const { return motion_at() + motion_states_; }

    /// WheelStep of wheel_observer.hpp.
    struct Motion {
        double slip, road;  // road: slip rate by the road
    };
    [[nodiscard]] Motion moved(const Motion& from, double pressed, double steady, double pole) const {
        const double change = acting_s(pole) * (from.road + pressed - steady);
        return {from.slip + change + steady * h_, from.road - pole * change};
    }
    [[nodiscard]] double acting_s(double pole) const { return pole > 0.0 ? h_ / (1.0 + pole * h_) : h_; }

    /// Gains of the settled observer: at the equilibrium nothing reveals the pole, and speed and road form a linear filter.
    struct Gains {
        double slip = 0.0, road = 0.0;
    };
    [[nodiscard]] Gains steady_gains(const antiskid::control::Config& config, double interval_s) const {
        const auto& o = config.observer;
        const double pitch_rad = 2.0 * kPi / static_cast<double>(config.wheel.encoder.teeth);
        const double tooth = static_cast<double>(o.reading_noise) * pitch_rad / interval_s;
        const double variance = tooth * tooth + kClockNoise_radps * kClockNoise_radps;
        const double road = static_cast<double>(o.road_noise_radps2);
        const double f = acting_s(pole_);
        Matrix2d moves, noise;
        moves << 1.0, f, 0.0, 1.0 - pole_ * f;
        noise << kSpeedNoise * kSpeedNoise * h_, 0.0, 0.0, road * road * h_;
        const Vector2d sees{1.0, -reading_age_};
        Matrix2d p = Matrix2d::Identity();
        Vector2d gains = Vector2d::Zero();
        for (double change = 1.0; change > 1e-12;) {
            for (std::size_t i = 0; i < reading_every_; ++i) p = (moves * p * moves.transpose() + noise).eval();
            const Vector2d seen = p * sees;
            const Vector2d next = seen / (sees.dot(seen) + variance);
            p -= next * seen.transpose();
            change = (next - gains).norm() / next.norm();
            gains = next;
        }
        return {gains[0], gains[1]};
    }

    /// ValveModel::input.
    [[nodiscard]] double input(const VectorXd& x, std::size_t ahead) const {
        const auto age = static_cast<Index>(whole_ - ahead);
        return (1.0 - part_) * x[age] + part_ * x[age + 1];
    }

    /// The encoder: mean slip over `reading_every_` periods, up to the last edge.
    [[nodiscard]] double reading(const VectorXd& x) const {
        double sum = 0.0;
        const auto n = static_cast<Index>(reading_every_);
        for (Index i = 0; i <= n; ++i) {
            const double weight = i == 0 ? 1.0 - edge_age_ : (i == n ? edge_age_ : 1.0);
            sum += weight * x[means_at() + i];
        }
        return sum / static_cast<double>(n);
    }

    double control(VectorXd& x, bool new_reading) const {
        const Index v = valve_at();
        if (correct_offset_ == 0.0) x[v + 5] = 0.0;  // not learnt: neither a state nor an integral
        const double before = x[v];
        Vector2d valve = model_.phi * x.segment<2>(v) + model_.gamma * (input(x, 0) + x[v + 5]);
        const double innovation = x[motion_at()] - valve[0];
        x[v + 5] += correct_offset_ * innovation;
        valve[0] += correct_p_ * innovation;
        valve[1] += correct_r_ * innovation;

        Motion motion{x[v + 2], x[v + 3]};
        motion = moved(motion, 0.5 * (before + valve[0]), -deceleration_per_s_ * motion.slip, pole_);
        if (new_reading) {
            const double slip_innovation = reading(x) - (motion.slip - (motion.road + valve[0]) * reading_age_);
            motion.slip += correct_.slip * slip_innovation;
            motion.road += correct_.road * slip_innovation;
        }

        const double steady = -deceleration_per_s_ * motion.slip;
        Vector2d late = valve;
        Motion there = motion;
        for (std::size_t i = 1; i <= whole_; ++i) {
            const double from = late[0];
            late = (model_.phi * late + model_.gamma * (input(x, i) + x[v + 5])).eval();
            there = moved(there, 0.5 * (from + late[0]), steady, believed_);
        }
        const double balance = steady - there.road;
        const double late_slip = there.slip;
        const double u = balance - gain_ * late_slip + x[v + 4] - static_cast<double>(law_.k_d) * (late[0] - balance) -
                         static_cast<double>(law_.k_dd_s) * late[1] - x[v + 5];
        x.segment<2>(v) = valve;
        x[v + 2] = motion.slip;
        x[v + 3] = motion.road;
        x[v + 4] -= static_cast<double>(law_.k_i_per_s2) * late_slip * h_;
        for (Index i = v - 1; i > 0; --i) x[i] = x[i - 1];
        x[0] = u;
        return u;
    }

    void move(VectorXd& x, double w) const {
        const Index p = plant_at(), m = motion_at();
        for (Index i = m - 1; i > p; --i) x[i] = x[i - 1];
        x[p] = w;
        // The command of `pipe_` periods ago acts after the fractional part of the delay, before that the previous one.
        const Index acting = p + static_cast<Index>(pipe_);
        const Index moving = motion_states_;
        VectorXd motion(moving + 1);
        motion << x.segment(m, moving), 0.0;
        motion = (plant_.phi * motion + plant_.new_input * x[acting] + plant_.old_input * x[acting + 1]).eval();
        x.segment(m, moving) = motion.head(moving);
        for (Index i = size() - 1; i > means_at(); --i) x[i] = x[i - 1];
        x[means_at()] = motion[moving] / h_;
    }

    antiskid::control::SlipConfig law_;
    double h_;
    std::size_t whole_ = 0, pipe_ = 0, reading_every_ = 1;
    double part_ = 0.0;
    double correct_p_ = 0.0, correct_r_ = 0.0, correct_offset_ = 0.0;
    double pole_ = 0.0, believed_ = 0.0, gain_ = 0.0;
    Gains correct_;
    double edge_age_ = 0.0, reading_age_ = 0.0, deceleration_per_s_ = 0.0;
    Lag model_;
    Index motion_states_ = 0;  // of valve, line and wheel
    SampledPlant plant_;
};

}  // namespace

PeriodicSystem law_system(const antiskid::control::Config& config, const rig::RigParameters& rig, const OperatingPoint& at,
                          Linearisation linearisation, std::optional<double> wheel_pole_radps) {
    const Period period(config, rig, at, linearisation, wheel_pole_radps);
    const Index n = period.size();
    PeriodicSystem s;
    s.period_s = static_cast<double>(config.period_s);
    s.controller_states = period.controller_states();
    s.b = VectorXd::Zero(n);
    static_cast<void>(period.step(s.b, 1.0, false));
    for (std::size_t k = 0; k < period.reading_every(); ++k) {
        MatrixXd a = MatrixXd::Identity(n, n);
        RowVectorXd c(n);
        for (Index i = 0; i < n; ++i) {
            VectorXd x = a.col(i);
            c[i] = period.step(x, 0.0, k == 0);
            a.col(i) = x;
        }
        s.a.push_back(std::move(a));
        s.c.push_back(std::move(c));
    }
    return s;
}

double scheduled_slip(const antiskid::control::SlipConfig& config, double slip_reference, double speed_mps) {
    const auto low_speed = static_cast<double>(config.low_speed_mps);
    if (speed_mps >= low_speed) return slip_reference;
    const double low = std::min(slip_reference, static_cast<double>(config.low_speed_slip));
    const auto floor = static_cast<double>(config.low_speed_floor_mps);
    return low + std::clamp((speed_mps - floor) / (low_speed - floor), 0.0, 1.0) * (slip_reference - low);
}

}  // namespace study::margins
