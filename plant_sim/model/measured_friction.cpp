#include "plant_sim/model/measured_friction.hpp"

#include <cmath>
#include <limits>

namespace plant {

double measured_friction(const FrictionCurve& curve, double friction, double end) {
    constexpr int kParts = 256;
    const double shift = friction - (curve[0] + curve[1] / 2.0 + curve[2] / 3.0 + curve[3] / 4.0);
    double sum = 0.0;
    for (int i = 0; i < kParts; ++i) {
        const double x = end + (1.0 - end) * (i + 0.5) / kParts;
        sum += 1.0 / (curve[0] + x * (curve[1] + x * (curve[2] + x * curve[3])) + shift);
    }
    return kParts / sum;
}

double mean_of_measured(const FrictionCurve& curve, double measured, double end) {
    constexpr int kMostSteps = 50;
    constexpr double kClose = 1e-9;
    double mean = measured;
    for (int i = 0; i < kMostSteps && least_friction(curve, mean) > 0.0; ++i) {
        const double off = measured - measured_friction(curve, mean, end);
        mean += off;
        if (std::abs(off) < kClose) return mean;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace plant
