#include "plant_sim/model/open_loop.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace plant {

namespace {

constexpr double kNoTime_s = 1e-9;
/// Error of a cubic through value and rate at both ends for a mode of the valve: amplitude (omega_n h)^4 / 384.
constexpr double kCubic = 384.0;
constexpr double kArcError_Pa = 100.0;

}  // namespace

OpenLoop::OpenLoop(const rig::RigParameters& parameters, Input input, std::span<const Point> profile, double tolerance)
    : parameters_(parameters),
      input_(input),
      wheel_(parameters.wheel, BrakeTorque(parameters.brake, parameters.friction_curve, parameters.mean_friction, parameters.brake_on_mps),
             parameters.surface, tolerance) {
    if (parameters.wheel.compliance.any() || parameters.valve.line_s > 0.0 || !parameters.runway.patches.empty())
        throw std::invalid_argument("open loop: a tyre or leg that gives way, a valve's line and a runway of patches need fixed steps");
    if (profile.empty()) throw std::invalid_argument("open loop: the profile has no points");
    if (parameters.load.lag_s > 0.0 && parameters.load.lift_Ns2pm2 > 0.0)
        throw std::invalid_argument("open loop: a loading device that lags behind eq. (2) needs fixed steps");
    const double delay_s = input == Input::valve ? parameters.valve.delay_s : 0.0;
    profile_.push_back({0.0, input == Input::valve ? 0.0 : profile.front().value_Pa});
    profile_.push_back({delay_s + std::max(profile.front().time_s, 0.0), profile_.back().value_Pa});
    for (const Point& point : profile) {
        if (!(point.time_s + delay_s >= profile_.back().time_s)) throw std::invalid_argument("open loop: time falls");
        profile_.push_back({point.time_s + delay_s, point.value_Pa});
    }
    if (input == Input::valve) {
        for (std::size_t i = 0; i < kSizes; ++i)
            transitions_[i] = ValveDynamics::transition(parameters.valve, std::ldexp(kShortest_s, static_cast<int>(i)));
    }
    load_ = {parameters.load.base_N, 0.0, parameters.load.lift_Ns2pm2};
    state_.v_mps = parameters.brake_on_mps;
    state_.omega_radps = state_.v_mps / wheel_.forces(state_, 0.0, load_).radius_m;
    state_.held = false;
    enter_piece();
    end_ = end();
}

void OpenLoop::enter_piece() {
    while (piece_ + 1 < profile_.size() && profile_[piece_ + 1].time_s <= time_s_ + kNoTime_s) ++piece_;
    const Point& a = profile_[piece_];
    const bool last = piece_ + 1 == profile_.size();
    piece_end_s_ = last ? HUGE_VAL : profile_[piece_ + 1].time_s;
    piece_slope_Paps_ = last ? 0.0 : (profile_[piece_ + 1].value_Pa - a.value_Pa) / (piece_end_s_ - a.time_s);
}

double OpenLoop::input_Pa(double time_s) const {
    const Point& a = profile_[piece_];
    return a.value_Pa + piece_slope_Paps_ * std::max(time_s - a.time_s, 0.0);
}

double OpenLoop::pressure_Pa() const {
    return std::max(input_ == Input::valve ? dynamics_.law_Pa() : input_Pa(time_s_), 0.0);
}

bool OpenLoop::arc_holds(double h) const {
    if (input_ == Input::pressure) return true;
    // The rest of the valve's transient, without its response to the ramp.
    const rig::ValveParameters& valve = parameters_.valve;
    const double lag_s = 2.0 * valve.damping / valve.natural_frequency_radps;
    const double amplitude_Pa = std::abs(dynamics_.law_Pa() - input_Pa(time_s_) + lag_s * piece_slope_Paps_) +
                                std::abs(dynamics_.rate_Paps() - piece_slope_Paps_) / valve.natural_frequency_radps;
    const double phase = valve.natural_frequency_radps * h;
    return amplitude_Pa * phase * phase * phase * phase <= kCubic * kArcError_Pa;
}

PressureArc OpenLoop::arc(ValveDynamics& dynamics, double h, bool listed) const {
    const double from_Pa = input_Pa(time_s_);
    const double to_Pa = from_Pa + piece_slope_Paps_ * h;
    if (input_ == Input::pressure) return PressureArc::linear(from_Pa, to_Pa);
    return dynamics.advance(listed ? transitions_[size_] : ValveDynamics::transition(parameters_.valve, h), from_Pa, to_Pa, h);
}

OpenLoop::End OpenLoop::end() const {
    const Forces f = wheel_.forces(state_, pressure_Pa(), load_);
    return {state_.v_mps, -f.F_x_N / parameters_.wheel.mass_kg, state_.omega_radps,
            (f.radius_m * f.F_x_N - f.brake_torque_Nm) / parameters_.wheel.inertia_kgm2};
}

bool OpenLoop::step(double end_s) {
    if (time_s_ >= end_s - kNoTime_s || state_.v_mps <= Wheel::kSlowest_mps) return false;
    if (time_s_ >= piece_end_s_ - kNoTime_s) {
        enter_piece();
        size_ = std::min(size_, kFresh);
        end_ = end();
    }
    while (size_ > 0 && !arc_holds(std::ldexp(kShortest_s, static_cast<int>(size_)))) --size_;
    const double left_s = std::min(piece_end_s_, end_s) - time_s_;
    const End start = end_;
    for (;; --size_) {
        double h = std::ldexp(kShortest_s, static_cast<int>(size_));
        const bool listed = h < left_s - kNoTime_s;
        if (!listed) h = left_s;
        ValveDynamics dynamics = dynamics_;
        pressure_arc_ = arc(dynamics, h, listed);
        double took = 0.0;
        if (size_ == 0)
            wheel_.advance(state_, pressure_arc_, load_, h);
        else
            took = wheel_.attempt(state_, pressure_arc_, load_, h);
        if (took > 1.0) continue;
        dynamics_ = dynamics;
        from_s_ = time_s_;
        per_step_ = 1.0 / h;
        time_s_ = listed ? time_s_ + h : std::min(piece_end_s_, end_s);
        if (listed && took < kRoomToDouble && size_ + 1 < kSizes) ++size_;
        end_ = end();
        v_ = Cubic::through(start.v, start.v_dot, end_.v, end_.v_dot, h);
        omega_ = Cubic::through(start.omega, start.omega_dot, end_.omega, end_.omega_dot, h);
        return true;
    }
}

}  // namespace plant
