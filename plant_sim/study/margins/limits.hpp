/// What no linear time-invariant controller can do: bounds on margins by an unstable pole behind a delay; and what the shipped law cannot.
///
/// With p the plant's pole and T the complementary sensitivity, internal stability asks T(p) = 1, and T carries the delay: the maximum
/// modulus principle gives |T| >= gamma = e^{p tau} somewhere on the axis. A controller that acts once in a period h has the delay of
/// whole periods, gamma = e^{p h (1 + floor(tau / h))}. From gamma follow the largest phase margin, 2 asin(1 / gamma), and the largest range
/// of gains that one controller can hold, ((gamma + 1) / (gamma - 1))^2 from end to end (Doyle, Francis, Tannenbaum, Feedback Control
/// Theory, 1992, sections 11.3 and 11.4; both proofs need of the plant only that factor of T). Bandwidth, noise and the valve's range
/// are not in it: what is infeasible here is infeasible for certain, what is not may still be out of reach. A controller that varies
/// periodically is not bound in its gain range (Khargonekar, Poolla, Tannenbaum, IEEE Trans. Automatic Control 30, 1985).
#pragma once

namespace study::margins {

/// What is asked of every cell.
struct Requirement {
    double phase_deg = 30.0;  ///< Section V
    double gain_dB = 6.0;     ///< up as well as down, in the place of the 30 dB printed there
};

struct Limits {
    double gamma = 1.0;            ///< least peak of |T|
    double phase_deg = 180.0;      ///< no controller has more
    double gain_range_dB = 1e300;  ///< upward and downward margin together are at most this
    [[nodiscard]] bool allow(const Requirement& r) const { return phase_deg >= r.phase_deg && gain_range_dB >= 2.0 * r.gain_dB; }
};

/// `wheel_pole_radps` as OperatingPoint has it: at or above zero nothing is limited. `period_s` 0: a controller in continuous time.
[[nodiscard]] Limits limits(double wheel_pole_radps, double delay_s, double period_s);

/// The fastest unstable pole, rad/s, for which `limits` still allows the requirement.
[[nodiscard]] double fastest_pole_radps(const Requirement& requirement, double delay_s, double period_s);

/// Upward gain margin, dB, in the brake's gain (in the valve's, where its offset is not learnt), of feed-forward and proportional gain on a
/// wheel that is stable and faster than the loop. Slip and road torque then follow the pressure at once: of a pressure p the law asks
/// p back and (k_p / a + k_answer) p less, so that a gain of 1 / (1 - k_answer - k_p / a) and more lets the pressure creep up. Derivative
/// terms and estimator do not enter; the integral adds up to half a dB. Infinite where nothing creeps: past the peak, or with k_p / a +
/// k_answer above 1.
[[nodiscard]] double creep_margin_dB(double wheel_pole_radps, double k_answer, double k_p_per_s);

}  // namespace study::margins
