/// The linearised wheel at an operating point: response of the slip of its rim, which carries brake and encoder, to brake torque, for the paper's
/// tyre, a ring tyre or one that relaxes (compliance.hpp).
#pragma once

#include <Eigen/Core>

#include <optional>
#include <vector>

#include "plant_sim/study/margins/loop.hpp"
#include "plant_sim/study/margins/operating_point.hpp"

namespace study::margins {

/// x' = a x + b q. x[0] is the rim's slip, 1 - omega r / v; q is the slip rate that the brake's torque would cause on a rigid wheel in the air, r k_b
/// P / (J v). Torque acts only on the rim: all elements of b but the first are zero.
///
/// If the tyre has them, the further states are: the belt's slip and the carcass's twist, as slip times the ring's natural frequency; the tread's
/// slip. As in Linearisation v, F_z, r and k_b are frozen. The leg is taken as rigid.
struct LinearWheel {
    Eigen::MatrixXd a;
    double gain = 1.0;  ///< b[0]: 1, or the effect of torque on a rim alone

    [[nodiscard]] std::vector<Complex> poles() const;
    /// Zeros of the transfer from q to the rim's slip: the motion behind a rim that is held.
    [[nodiscard]] std::vector<Complex> zeros() const;
    /// The oscillation with the fastest growth (real part, 1/s; imaginary part, rad/s, positive); none: no oscillation.
    [[nodiscard]] std::optional<Complex> swing() const;
};

[[nodiscard]] LinearWheel linear_wheel(const OperatingPoint& at, Linearisation linearisation);

}  // namespace study::margins
