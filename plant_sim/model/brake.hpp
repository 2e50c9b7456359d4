/// From brake pressure to brake torque: T_b = k_b P_b, k_b = mu_b A_p N_p N_s R_eff, eq. (5), with mu_b
/// varying within a stop (Fig. 6).
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace plant {

struct BrakeGeometry {
    double piston_area_m2 = 0.0;      ///< A_p
    double pistons = 0.0;             ///< N_p
    double surfaces = 0.0;            ///< N_s
    double effective_radius_m = 0.0;  ///< R_eff

    /// k_b per unit of friction, m^3.
    [[nodiscard]] double gain_m3() const { return piston_area_m2 * pistons * surfaces * effective_radius_m; }
};

/// The shape of mu_b over a stop as a polynomial in x = v / v_brake_on, lowest power first (Fig. 6), absolute
/// values.
using FrictionCurve = std::array<double, 4>;

/// The least mu_b over a stop when the curve is brought to the mean `friction`. At or below zero no brake is like that.
[[nodiscard]] double least_friction(const FrictionCurve& curve, double friction);

/// The least mean that leaves at least 0.01 of friction everywhere on the curve: what a brake that is worn beyond use is taken to have.
[[nodiscard]] double least_mean_friction(const FrictionCurve& curve);

/// k_b(v): the friction curve of the maneuver's class, shifted so that its mean over a stop of constant
/// deceleration is `mean_friction` (Section IV: "a suitably biased version ... adapted to match the extracted
/// mean"), times the geometry.
class BrakeTorque {
  public:
    BrakeTorque() = default;  ///< none
    BrakeTorque(const BrakeGeometry& geometry, const FrictionCurve& curve, double mean_friction,
                double brake_on_mps);

    struct Gain {
        double k_b;   ///< m^3
        double k_b1;  ///< d k_b / d v, m^2 s
    };

    /// Beyond the brake-on speed the curve is held.
    [[nodiscard, gnu::always_inline]] inline Gain gain(double v_mps) const {
        const double x = v_mps * inverse_speed_;
        const double k_b = c_[0] + x * (c_[1] + x * (c_[2] + x * c_[3]));
        const double k_b1 = (c_[1] + x * (2.0 * c_[2] + x * 3.0 * c_[3])) * inverse_speed_;
        return {x >= 1.0 ? full_speed_gain_ : k_b, x >= 1.0 ? 0.0 : k_b1};
    }

  private:
    FrictionCurve c_{};
    double inverse_speed_ = 0.0;
    double full_speed_gain_ = 0.0;
};

}  // namespace plant
