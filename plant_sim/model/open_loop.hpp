/// The plant under a prescribed profile, without controller and sensors. Steps are as long as the motion allows, many times longer than those of Rig.
///
///     OpenLoop plant(rig, OpenLoop::Input::valve, profile);
///     for (double t = 0.0; plant.step(10.0);)
///         for (; t <= plant.time_s(); t += 1e-3) use(plant.at(t));
///
/// Valve, brake, wheel and tyre are those of Rig. Eq. (6) is solved exactly over steps of any length.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "plant_sim/model/rig.hpp"

namespace plant {

class OpenLoop {
  public:
    enum class Input {
        pressure,  ///< brake pressure; the valve is bypassed
        valve,     ///< static pressure, the input of delay and dynamics of eq. (6)
    };
    /// A point of the profile: linear between points, constant before the first and after the last. Times do not decrease; two points of the same
    /// time are a jump.
    struct Point {
        double time_s;    ///< >= 0
        double value_Pa;  ///< >= 0
    };

    /// Tolerances of a step, see Wheel. With kCoarse the error of speeds is at most 1e-4 while friction stays below its peak. Beyond the peak the
    /// wheel is unstable and errors grow; with kFine they stay within 1e-4 there too, at about four times the cost.
    static constexpr double kCoarse = 1e-5;
    static constexpr double kFine = 3e-8;

    /// Starts with the wheel rolling freely at the maneuver's speed, without pressure. Throws std::invalid_argument for an empty profile, decreasing
    /// times, a lagging loading device under a load that depends on speed, and what only Rig can do: compliant tyre or leg, a hydraulic line, a
    /// runway with patches.
    OpenLoop(const rig::RigParameters& parameters, Input input, std::span<const Point> profile, double tolerance = kCoarse);

    /// Makes one step, at most to `end_s`. False: `end_s` is reached, or the wheel stands.
    bool step(double end_s);

    [[nodiscard]] double time_s() const { return time_s_; }
    [[nodiscard]] const WheelState& wheel() const { return state_; }
    [[nodiscard]] double pressure_Pa() const;

    struct Sample {
        double v_mps, omega_radps, pressure_Pa;
    };
    /// State at a time within the last step, by cubics through speeds and rates at its ends.
    [[nodiscard]] Sample at(double time_s) const {
        const double x = (time_s - from_s_) * per_step_;
        const double omega = omega_.at(x);
        return {v_.at(x), omega > 0.0 ? omega : 0.0, pressure_arc_.at(x)};
    }

  private:
    /// A step is kShortest_s times a power of two, or the rest of a piece of the profile.
    static constexpr double kShortest_s = 1e-3 / 32.0;
    static constexpr std::size_t kSizes = 12;  // up to 64 ms
    static constexpr std::size_t kFresh = 5;   // 1 ms, the longest step after a corner of the profile
    static constexpr double kRoomToDouble = 1.0 / 32.0;

    struct End {
        double v, v_dot, omega, omega_dot;
    };
    /// A cubic over the last step, x in [0, 1].
    struct Cubic {
        double c0 = 0.0, c1 = 0.0, c2 = 0.0, c3 = 0.0;

        [[nodiscard]] static Cubic through(double y0, double rate0, double y1, double rate1, double h) {
            const double m0 = rate0 * h;
            const double m1 = rate1 * h;
            return {y0, m0, 3.0 * (y1 - y0) - 2.0 * m0 - m1, 2.0 * (y0 - y1) + m0 + m1};
        }
        [[nodiscard]] double at(double x) const { return c0 + x * (c1 + x * (c2 + x * c3)); }
    };
    [[nodiscard]] End end() const;
    void enter_piece();
    [[nodiscard]] double input_Pa(double time_s) const;
    /// Whether one cubic approximates the valve's pressure over the next `h`.
    [[nodiscard]] bool arc_holds(double h) const;
    [[nodiscard]] PressureArc arc(ValveDynamics& dynamics, double h, bool listed) const;

    rig::RigParameters parameters_;
    Input input_;
    std::vector<Point> profile_;  // shifted by the valve's delay
    Wheel wheel_;
    LoadArc load_;
    ValveDynamics dynamics_;
    std::array<ValveDynamics::Transition, kSizes> transitions_{};
    WheelState state_;
    double time_s_ = 0.0;
    std::size_t size_ = 0;   // of the next step
    std::size_t piece_ = 0;  // point at which the present piece of the profile begins
    double piece_end_s_ = 0.0;
    double piece_slope_Paps_ = 0.0;
    // The last step, for at().
    double from_s_ = 0.0;
    double per_step_ = 0.0;
    Cubic v_, omega_;
    PressureArc pressure_arc_;
    End end_{};
};

}  // namespace plant
