/// Bounds on the margins of any linear time-invariant controller, from an unstable pole behind a delay; and a bound for the shipped law.
///
/// With p the plant's pole and T the complementary sensitivity, internal stability requires T(p) = 1, and T contains the delay: by the maximum
/// modulus principle |T| >= gamma = e^{p tau} somewhere on the axis. A controller that acts once in a period h has a delay of whole periods, gamma =
/// e^{p h (1 + floor(tau / h))}. From gamma follow the largest phase margin, 2 asin(1 / gamma), and the largest range of gains that one controller
/// can hold, ((gamma + 1) / (gamma - 1))^2 from end to end (Doyle, Francis, Tannenbaum, Feedback Control Theory, 1992, sections 11.3 and 11.4; both
/// proofs use only that factor of T of the plant). Bandwidth, noise and the valve's range are not considered: what is infeasible here is certainly
/// infeasible, and other cases may be infeasible, too. A periodically varying controller may have a larger range of gains (Khargonekar, Poolla,
/// Tannenbaum, IEEE Trans. Automatic Control 30, 1985).
#pragma once

namespace study::margins {

/// Required margins of each cell.
struct Requirement {
    double phase_deg = 30.0;  ///< Section V
    double gain_dB = 6.0;     ///< upwards and downwards, instead of the 30 dB printed there
};

struct Limits {
    double gamma = 1.0;            ///< least peak of |T|
    double phase_deg = 180.0;      ///< largest possible phase margin
    double gain_range_dB = 1e300;  ///< largest possible sum of upward and downward gain margin
    [[nodiscard]] bool allow(const Requirement& r) const { return phase_deg >= r.phase_deg && gain_range_dB >= 2.0 * r.gain_dB; }
};

/// `wheel_pole_radps`: see OperatingPoint; without limits if it is not negative. `period_s` 0: a controller in continuous time.
[[nodiscard]] Limits limits(double wheel_pole_radps, double delay_s, double period_s);

/// Upward gain margin, dB, in the brake's gain (or in the valve's, if its offset is not learnt), of feed-forward and proportional gain on a stable
/// wheel that is faster than the loop. Slip and road torque then follow the pressure at once: for a pressure p the law requests p minus (k_p / a +
/// k_pole) p, so that from a gain of 1 / (1 - k_pole - k_p / a) on the pressure creeps up. Derivative terms and estimator have no effect; the
/// integral adds up to half a dB. Infinite if nothing creeps: past the peak, or with k_p / a + k_pole above 1.
[[nodiscard]] double creep_margin_dB(double wheel_pole_radps, double k_pole, double k_p_per_s);

}  // namespace study::margins
