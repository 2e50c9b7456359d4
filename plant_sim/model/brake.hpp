/// Brake torque from brake pressure: T_b = k_b P_b, k_b = mu_b A_p N_p N_s R_eff, eq. (5). mu_b varies within a stop (Fig. 6).
#pragma once

#include "rig_bridge/rig/rig_parameters.hpp"

namespace plant {

/// The brake's gain k_b(v): the geometry times the friction curve of the maneuver's class. The curve is shifted so that its mean over a stop of
/// constant deceleration is `mean_friction` (Section IV: "a suitably biased version ... adapted to match the extracted mean").
class BrakeTorque {
  public:
    BrakeTorque() = default;  ///< a brake without torque
    BrakeTorque(const rig::BrakeGeometry& geometry, const rig::FrictionCurve& curve, double mean_friction, double brake_on_mps);

    struct Gain {
        double k_b;   ///< m^3
        double k_b1;  ///< d k_b / d v, m^2 s
    };

    /// Gain at speed `v_mps`; constant above the brake-on speed.
    [[nodiscard, gnu::always_inline]] inline Gain gain(double v_mps) const {
        const double x = v_mps * inverse_speed_;
        const double k_b = c_[0] + x * (c_[1] + x * (c_[2] + x * c_[3]));
        const double k_b1 = (c_[1] + x * (2.0 * c_[2] + x * 3.0 * c_[3])) * inverse_speed_;
        return {x >= 1.0 ? full_speed_gain_ : k_b, x >= 1.0 ? 0.0 : k_b1};
    }

  private:
    rig::FrictionCurve c_{};
    double inverse_speed_ = 0.0;
    double full_speed_gain_ = 0.0;
};

}  // namespace plant
