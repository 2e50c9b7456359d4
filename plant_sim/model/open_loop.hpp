/// The plant alone under a prescribed profile, with steps as long as the motion allows: many times faster than `Rig`, no sensors.
///
///     OpenLoop plant(rig, OpenLoop::Input::valve, profile);
///     for (double t = 0.0; plant.step(10.0);)
///         for (; t <= plant.time_s(); t += 1e-3) use(plant.at(t));
///
/// Valve, brake, wheel and tyre are those of `Rig`; eq. (6) is solved exactly over steps of any length.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "plant_sim/model/rig.hpp"

namespace plant {

class OpenLoop {
  public:
    enum class Input {
        pressure,  ///< brake pressure, the valve bypassed
        valve,     ///< static pressure before delay and dynamics of eq. (6)
    };
    /// Linear between points, a jump where two have the same time, held before the first and after the last. Times do not fall.
    struct Point {
        double time_s;    ///< >= 0
        double value_Pa;  ///< >= 0
    };

    /// Tolerances of a step, see Wheel. With kCoarse speeds are right to 1e-4 while the friction stays below its peak. Beyond it the wheel
    /// is unstable and errors grow: with kFine they are right to 1e-4 there too, at some four times the cost.
    static constexpr double kCoarse = 1e-5;
    static constexpr double kFine = 3e-8;

    /// The wheel rolls freely at the maneuver's speed, without pressure. Throws std::invalid_argument for an empty profile, falling times,
    /// a loading device that lags behind a load that changes with speed, and what only Rig has: tyre or leg that give way, a valve's line,
    /// a runway of patches.
    OpenLoop(const rig::RigParameters& parameters, Input input, std::span<const Point> profile, double tolerance = kCoarse);

    /// One step, at most to `end_s`; false when it is reached or the wheel stands still.
    bool step(double end_s);

    [[nodiscard]] double time_s() const { return time_s_; }
    [[nodiscard]] const WheelState& wheel() const { return state_; }
    [[nodiscard]] double pressure_Pa() const;

    struct Sample {
        double v_mps, omega_radps, pressure_Pa;
    };
    /// Within the last step, by cubics through speeds and rates at its ends.
    [[nodiscard]] Sample at(double time_s) const {
        const double x = (time_s - from_s_) * per_step_;
        const double omega = omega_.at(x);
        return {v_.at(x), omega > 0.0 ? omega : 0.0, pressure_arc_.at(x)};
    }

  private:
    /// Steps are kShortest_s times a power of two, or what is left of a piece of the profile.
    static constexpr double kShortest_s = 1e-3 / 32.0;
    static constexpr std::size_t kSizes = 12;  // up to 64 ms
    static constexpr std::size_t kFresh = 5;   // 1 ms, the most after a corner of the profile
    static constexpr double kRoomToDouble = 1.0 / 32.0;

    struct End {
        double v, v_dot, omega, omega_dot;
    };
    /// Over the last step, x in [0, 1].
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
    /// Whether one cubic follows the valve over the next `h`.
    [[nodiscard]] bool arc_holds(double h) const;
    [[nodiscard]] PressureArc arc(ValveDynamics& dynamics, double h, bool listed) const;

    rig::RigParameters parameters_;
    Input input_;
    std::vector<Point> profile_;  // delayed
    Wheel wheel_;
    LoadArc load_;
    ValveDynamics dynamics_;
    std::array<ValveDynamics::Transition, kSizes> transitions_{};
    WheelState state_;
    double time_s_ = 0.0;
    std::size_t size_ = 0;   // of the step to try next
    std::size_t piece_ = 0;  // the point at which the present piece of the profile begins
    double piece_end_s_ = 0.0;
    double piece_slope_Paps_ = 0.0;
    // The last step, for what lies within.
    double from_s_ = 0.0;
    double per_step_ = 0.0;
    Cubic v_, omega_;
    PressureArc pressure_arc_;
    End end_{};
};

}  // namespace plant
