#include "plant_sim/model/brake.hpp"

namespace plant {

BrakeTorque::BrakeTorque(const rig::BrakeGeometry& geometry, const rig::FrictionCurve& curve, double mean_friction, double brake_on_mps)
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
