/// The pressure valve, eq. (6): static current-to-pressure map, transport delay, second-order dynamics; and the line to the brake.
#pragma once

#include <algorithm>
#include <vector>

#include "plant_sim/model/wheel.hpp"

namespace plant {

/// Hysteresis of the static map as play: the current in effect follows the commanded one only at the edges of a band of this width, so
/// that the branch of rising current lies half a width to the right of the map and the falling one half a width to the left. Width 0: no
/// play, to the last bit.
class Play {
  public:
    explicit Play(double width_mA) : half_mA_(0.5 * width_mA) {}

    /// The current in effect after the commanded one has gone to `current_mA` without turning.
    double follow(double current_mA) {
        effect_mA_ = std::clamp(effect_mA_, current_mA - half_mA_, current_mA + half_mA_);
        return effect_mA_;
    }

  private:
    double half_mA_;
    double effect_mA_ = 0.0;
};

/// Eq. (6) without its delay, and the line behind it, solved exactly for a static pressure that is linear in time.
class ValveDynamics {
  public:
    /// Over one step: state and an input from u0 to u1.
    struct Transition {
        double pp, pr, pu0, pu1;  // new pressure from pressure, rate, u0, u1
        double rp, rr, ru0, ru1;  // new rate
        double per_line = 0.0;    // 1 / line_s; 0: no line
        double bb = 0.0, bp = 0.0, br = 0.0, bu0 = 0.0,
               bu1 = 0.0;  // new pressure at the brake, from that before and the others
    };
    [[nodiscard]] static Transition transition(const rig::ValveParameters& parameters, double h);

    /// One step of the `h` that `transition` was made for.
    PressureArc advance(const Transition& transition, double u0, double u1, double h);

    [[nodiscard]] double law_Pa() const { return pressure_; }  ///< of eq. (6); may undershoot zero
    [[nodiscard]] double rate_Paps() const { return rate_; }
    [[nodiscard]] double brake_Pa() const { return brake_; }  ///< at the line's end

  private:
    double pressure_ = 0.0;
    double rate_ = 0.0;
    double brake_ = 0.0;
};

/// Eq. (6) and the line on a fixed step.
class Valve {
  public:
    /// `step_s`: the fixed time between calls of `advance`.
    Valve(const rig::ValveParameters& parameters, double step_s);

    /// One step in which the static pressure before the delay goes linearly from `start_Pa` to `end_Pa`
    /// (equal for a held command). The delay cuts the step in two where it is no multiple of it: `first`
    /// lasts `first_s()`, `second` the rest; `first` is unused when `first_s()` is 0.
    struct Arcs {
        PressureArc first;
        PressureArc second;
    };
    Arcs advance(double start_Pa, double end_Pa);

    [[nodiscard]] double first_s() const { return first_s_; }
    [[nodiscard]] double second_s() const { return second_s_; }

    /// What a gauge at the brake reads: never below zero.
    [[nodiscard]] double pressure_Pa() const { return std::max(dynamics_.brake_Pa(), 0.0); }

  private:
    struct Ramp {
        double start_Pa, end_Pa;
    };

    double step_s_;
    double first_s_ = 0.0;
    double second_s_ = 0.0;
    ValveDynamics::Transition first_{}, second_{};
    std::vector<Ramp> delay_line_;  // ring; oldest at next_
    std::size_t next_ = 0;
    ValveDynamics dynamics_;
};

}  // namespace plant
