/// The wheel of one operating point, linearised: how the slip of its rim, which carries brake and encoder, answers brake torque on the
/// paper's tyre, on a ring or on one that relaxes (compliance.hpp).
#pragma once

#include <Eigen/Core>

#include <optional>
#include <vector>

#include "plant_sim/study/margins/loop.hpp"
#include "plant_sim/study/margins/operating_point.hpp"

namespace study::margins {

/// x' = a x + b q, with x[0] the rim's slip, 1 - omega r / v, and q the slip rate that the brake's torque would cause on a rigid wheel in
/// the air, r k_b P / (J v). Torque reaches the rim alone: b is zero but for its first element.
///
/// Behind the rim's slip come, where the tyre has them: the belt's slip and the carcass's twist, as slip times the ring's own frequency;
/// the tread's slip. As in Linearisation v, F_z, r and k_b are frozen. A leg is taken for rigid.
struct LinearWheel {
    Eigen::MatrixXd a;
    double gain = 1.0;  ///< b[0]: 1, or what torque does to a rim alone

    [[nodiscard]] std::vector<Complex> poles() const;
    /// Of the way from q to the rim's slip: what would move behind a rim that is held.
    [[nodiscard]] std::vector<Complex> zeros() const;
    /// The swing that grows fastest (real part, 1/s; imaginary part, rad/s, above zero); none where nothing swings.
    [[nodiscard]] std::optional<Complex> swing() const;
};

[[nodiscard]] LinearWheel linear_wheel(const OperatingPoint& at, Linearisation linearisation);

}  // namespace study::margins
