/// The pressure valve, eq. (6): static map from current to pressure, transport delay, second-order dynamics; and the hydraulic line to the brake.
#pragma once

#include <algorithm>
#include <vector>

#include "plant_sim/model/wheel.hpp"

namespace plant {

/// Hysteresis of the static map, as mechanical play: the effective current changes only while the commanded one is at an edge of a band of this
/// width. The branch of rising current therefore lies half a width right of the map, the falling one half a width left. Width 0: exactly no
/// hysteresis.
class Play {
  public:
    explicit Play(double width_mA) : half_mA_(0.5 * width_mA) {}

    /// Takes the commanded current, which has changed monotonically since the last call; returns the effective current, mA.
    double follow(double current_mA) {
        effect_mA_ = std::clamp(effect_mA_, current_mA - half_mA_, current_mA + half_mA_);
        return effect_mA_;
    }

  private:
    double half_mA_;
    double effect_mA_ = 0.0;
};

/// Eq. (6) without its delay, followed by the line; exact for a static pressure that is linear in time.
class ValveDynamics {
  public:
    /// Coefficients of one step; the input, static pressure, goes from u0 to u1.
    struct Transition {
        double pp, pr, pu0, pu1;  // new pressure by old pressure, old rate, u0, u1
        double rp, rr, ru0, ru1;  // new rate
        double per_line = 0.0;    // 1 / line_s; 0: no line
        double bb = 0.0, bp = 0.0, br = 0.0, bu0 = 0.0,
               bu1 = 0.0;  // new pressure at the brake, from its old value and the others
    };
    [[nodiscard]] static Transition transition(const rig::ValveParameters& parameters, double h);

    /// Advances by one step of length `h`, the one that `transition` was computed for; returns the pressure at the brake over the step.
    PressureArc advance(const Transition& transition, double u0, double u1, double h);

    [[nodiscard]] double law_Pa() const { return pressure_; }  ///< state of eq. (6); may be slightly negative
    [[nodiscard]] double rate_Paps() const { return rate_; }
    [[nodiscard]] double brake_Pa() const { return brake_; }  ///< at the end of the line

  private:
    double pressure_ = 0.0;
    double rate_ = 0.0;
    double brake_ = 0.0;
};

/// Eq. (6) and the line with a fixed step.
class Valve {
  public:
    /// `step_s`: the fixed time between calls of `advance`.
    Valve(const rig::ValveParameters& parameters, double step_s);

    /// Pressure over one step, cut in two where the delay is no multiple of the step: `first` lasts first_s() and is unused if that is 0, `second`
    /// lasts the rest.
    struct Arcs {
        PressureArc first;
        PressureArc second;
    };
    Arcs advance(double start_Pa, double end_Pa);

    [[nodiscard]] double first_s() const { return first_s_; }
    [[nodiscard]] double second_s() const { return second_s_; }

    /// Pressure at the brake, >= 0.
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
