#include "rig_bridge/rig/friction_curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rig {

double min_friction(const FrictionCurve& curve, double friction) {
    constexpr int kParts = 256;
    const double mean = curve[0] + curve[1] / 2.0 + curve[2] / 3.0 + curve[3] / 4.0;
    double min = friction;
    for (int i = 0; i <= kParts; ++i) {
        const double x = static_cast<double>(i) / kParts;
        const double at = curve[0] + x * (curve[1] + x * (curve[2] + x * curve[3]));
        min = std::min(min, at - mean + friction);
    }
    return min;
}

double min_mean_friction(const FrictionCurve& curve) {
    constexpr double kLeft = 0.01;
    return kLeft - min_friction(curve, 0.0);
}

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
    constexpr int kMaxSteps = 50;
    constexpr double kClose = 1e-9;
    double mean = measured;
    for (int i = 0; i < kMaxSteps && min_friction(curve, mean) > 0.0; ++i) {
        const double off = measured - measured_friction(curve, mean, end);
        mean += off;
        if (std::abs(off) < kClose) return mean;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace rig
