/// Stability by Nyquist's criterion, and the margins to its loss.
#pragma once

#include <limits>
#include <vector>

#include "plant_sim/study/margins/loop.hpp"

namespace study::margins {

/// Margins of a stable closed loop. Where it is not stable they mean nothing and are NaN.
struct Margins {
    int encirclements = 0;    ///< of -1, counter-clockwise, over the whole axis
    int unstable_poles = 0;   ///< of L
    int unstable_closed = 0;  ///< closed-loop poles on the right: unstable_poles - encirclements, or on the axis within 1e-9
    bool stable = false;

    double phase_deg = std::numeric_limits<double>::quiet_NaN();        ///< smallest turn of L, lag or lead, onto -1; 180 if there is none
    double gain_up_dB = std::numeric_limits<double>::quiet_NaN();       ///< smallest rise in gain that reaches -1; infinite if none up to 60 dB does
    double gain_down_dB = std::numeric_limits<double>::quiet_NaN();     ///< smallest fall, as a positive number; infinite if none does
    double modulus = std::numeric_limits<double>::quiet_NaN();          ///< least |1 + L|, the inverse of the peak sensitivity
    double crossover_radps = std::numeric_limits<double>::quiet_NaN();  ///< |L| = 1 where `phase_deg` is found
    double upward_radps = std::numeric_limits<double>::quiet_NaN();     ///< where a rise in gain begins to oscillate
    double downward_radps = std::numeric_limits<double>::quiet_NaN();
};

/// Walks the axis from the indent at s = 0 to the loop's end. A step is taken only where Loop::max_approach keeps every locus closer to
/// where it is than half its distance to -1; so no turn around -1 can hide between two points, whatever the grid. Crossings are found to a
/// relative frequency of 1e-10. Throws std::runtime_error where -1 lies on the locus so closely that no step is short enough.
/// `ratio`: longest step along the axis, next frequency over this one.
[[nodiscard]] Margins margins(const Loop& loop, double ratio = 1.05);

/// The walk's points, for a picture.
struct LocusPoint {
    double frequency_radps;
    Complex value;
};
/// The largest locus at `count` frequencies, evenly spaced by their logarithm.
[[nodiscard]] std::vector<LocusPoint> locus(const Loop& loop, double from_radps, double to_radps, int count);

}  // namespace study::margins
