/// Friction of the brake over a stop, as eq. (7) measures it, and the mean of the curve behind it.
///
/// mu_b varies within a stop (Fig. 6), and eq. (7) divides mean torque by mean pressure: at constant torque that is a harmonic mean over the stop, 1
/// to 4 % below the curve's arithmetic mean, with a larger difference at lower friction.
#pragma once

#include <array>

namespace rig {

/// The shape of mu_b over a stop as a polynomial in x = v / v_brake_on, lowest power first (Fig. 6), absolute
/// values.
using FrictionCurve = std::array<double, 4>;

/// The least mu_b over a stop when the curve is brought to the mean `friction`. At or below zero no brake is like that.
[[nodiscard]] double min_friction(const FrictionCurve& curve, double friction);

/// The least mean that leaves at least 0.01 of friction everywhere on the curve: what a brake that is worn beyond use is taken to have.
[[nodiscard]] double min_mean_friction(const FrictionCurve& curve);

/// What eq. (7) gives over a stop at constant torque and deceleration from brake-on down to `end` (0 to below 1) of that speed, with the
/// curve brought to the mean `friction` as BrakeTorque does; positive friction everywhere, see min_friction().
[[nodiscard]] double measured_friction(const FrictionCurve& curve, double friction, double end);

/// The mean for which measured_friction() gives `measured`; NaN if there is none on this curve.
[[nodiscard]] double mean_of_measured(const FrictionCurve& curve, double measured, double end);

}  // namespace rig
