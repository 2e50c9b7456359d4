/// Stability by Nyquist's criterion, and the margins to its loss.
#pragma once

#include <limits>
#include <vector>

#include "plant_sim/study/margins/loop.hpp"

namespace study::margins {

/// Margins of a stable closed loop; NaN for an unstable one.
struct Margins {
    int encirclements = 0;    ///< of -1, counter-clockwise, over the whole axis
    int unstable_poles = 0;   ///< of L
    int unstable_closed = 0;  ///< number of unstable closed-loop poles: unstable_poles - encirclements; a pole within 1e-9 of the axis counts
    bool stable = false;

    double phase_deg = std::numeric_limits<double>::quiet_NaN();     ///< smallest rotation of L, lag or lead, that reaches -1; 180 if none does
    double gain_up_dB = std::numeric_limits<double>::quiet_NaN();    ///< smallest increase of gain that reaches -1; infinite if none up to 60 dB does
    double gain_down_dB = std::numeric_limits<double>::quiet_NaN();  ///< smallest decrease, as a positive number; infinite if none does
    double modulus = std::numeric_limits<double>::quiet_NaN();       ///< least |1 + L|, the inverse of the peak sensitivity
    double crossover_radps = std::numeric_limits<double>::quiet_NaN();  ///< frequency of `phase_deg`, at |L| = 1
    double upward_radps = std::numeric_limits<double>::quiet_NaN();     ///< frequency at which an increase of gain begins to oscillate
    double downward_radps = std::numeric_limits<double>::quiet_NaN();
};

/// Follows the axis from the indent at s = 0 to the loop's end. Steps are so short that by Loop::max_approach no locus moves by more than half of its
/// distance to -1; no encirclement can therefore be missed, whatever the grid. Crossings are found to a relative frequency of 1e-10. Throws
/// std::runtime_error if a locus passes so near to -1 that no step is short enough. `ratio`: largest ratio of successive frequencies.
[[nodiscard]] Margins margins(const Loop& loop, double ratio = 1.05);

/// A point of the locus for a picture.
struct LocusPoint {
    double frequency_radps;
    Complex value;
};
/// The largest locus at `count` frequencies with a constant ratio.
[[nodiscard]] std::vector<LocusPoint> locus(const Loop& loop, double from_radps, double to_radps, int count);

}  // namespace study::margins
