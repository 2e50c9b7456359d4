#include "plant_sim/model/brake.hpp"

#include <algorithm>

namespace plant {

double least_friction(const FrictionCurve& curve, double friction) {
    constexpr int kParts = 256;
    const double mean = curve[0] + curve[1] / 2.0 + curve[2] / 3.0 + curve[3] / 4.0;
    double least = friction;
    for (int i = 0; i <= kParts; ++i) {
        const double x = static_cast<double>(i) / kParts;
        const double at = curve[0] + x * (curve[1] + x * (curve[2] + x * curve[3]));
        least = std::min(least, at - mean + friction);
    }
    return least;
}

double least_mean_friction(const FrictionCurve& curve) {
    constexpr double kLeft = 0.01;
    return kLeft - least_friction(curve, 0.0);
}

BrakeTorque::BrakeTorque(const BrakeGeometry& geometry, const FrictionCurve& curve, double mean_friction,
                         double brake_on_mps)
    : c_(curve), inverse_speed_(1.0 / brake_on_mps) {
    // At constant deceleration time and speed are proportional: the mean over time is the mean over x in [0,
    // 1].
    double mean = 0.0;
    for (std::size_t i = 0; i < c_.size(); ++i) mean += c_[i] / static_cast<double>(i + 1);
    c_[0] += mean_friction - mean;
    for (double& c : c_) {
        c *= geometry.gain_m3();
        full_speed_gain_ += c;
    }
}

}  // namespace plant
