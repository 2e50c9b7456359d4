/// Speed of the braked wheel, what the road gives, and how that answers slip: an extended Kalman filter on readings of the encoder and the
/// brake's torque.
///
/// State, all of the wheel: omega (rad/s); tau = r F_x / J_w (rad/s2); the road's answer a (1/s). With u = k_b P / J_w, and with what keeps
/// the slip, omega v_dot / v, eq. (1b) and (3) are
///
///     omega_dot = tau - u        tau_dot = a (u + omega v_dot / v - tau)        a = F_z r^2 mu'(lambda) / (J_w v)
///
/// a is large where friction rises steeply with slip and the speed is low: the wheel hangs on the road. It is 0 at the peak, negative
/// beyond it: the wheel runs away as exp(|a| t).
#pragma once

#include "firmware/control/arithmetic.hpp"
#include "firmware/control/config.hpp"
#include "firmware/control/speed_estimator.hpp"

namespace antiskid::control {

/// Where the wheel is, or will be.
struct WheelMotion {
    float omega_radps = 0.0F;
    float road_radps2 = 0.0F;  ///< tau
};

/// A step of the equations above with what acts held. Implicit where the road restores, which is stable for any step; explicit where it
/// does not.
class WheelStep {
  public:
    WheelStep(float answer_per_s, float step_s)
        : answer_per_s_(answer_per_s), step_s_(step_s), acting_s_(answer_per_s > 0.0F ? step_s / (1.0F + answer_per_s * step_s) : step_s) {}

    [[nodiscard]] WheelMotion from(const WheelMotion& at, float brake_radps2, float steady_radps2) const {
        const float change = acting_s_ * (at.road_radps2 - brake_radps2 - steady_radps2);
        return {larger(at.omega_radps + change + steady_radps2 * step_s_, 0.0F), at.road_radps2 - answer_per_s_ * change};
    }
    /// The share of the step over which an excess of torque acts.
    [[nodiscard]] float acting_s() const { return acting_s_; }

  private:
    float answer_per_s_;
    float step_s_;
    float acting_s_;
};

class WheelObserver {
  public:
    WheelObserver(const ObserverConfig& config, const WheelConfig& wheel, float period_s);

    /// What acts over a period, as accelerations of the wheel.
    struct Drive {
        float brake_radps2 = 0.0F;      ///< k_b P / J_w, mean over the period
        float brake_now_radps2 = 0.0F;  ///< at its end
        float steady_radps2 = 0.0F;     ///< omega v_dot / v
    };
    /// One period. A reading that is not valid, or a wheel that stands, begins anew. So does a reading that no wheel can have got to, the
    /// encoder's patience after the last one that was believed; before that it is left out. Readings that stay off to one side mean another
    /// road: what was learnt of it is forgotten.
    void update(const SpeedReading& reading, const Drive& drive);

    [[nodiscard]] const WheelMotion& motion() const { return motion_; }
    [[nodiscard]] float answer_per_s() const { return answer_per_s_; }
    [[nodiscard]] float answer_variance_per_s2() const { return aa_; }
    /// The last update met another road.
    [[nodiscard]] bool another_road() const { return another_road_; }

  private:
    void begin(float omega_radps);
    void predict(const Drive& drive);
    void correct(const SpeedReading& reading, const Drive& drive);
    [[nodiscard]] bool is_another_road(float surprise, float since_s, float variance);
    void forget_road(float reading_variance);

    ObserverConfig config_;
    float max_radps_;
    float max_radps2_;
    float pitch_rad_;
    float patience_s_;
    float hardest_brake_;
    float period_s_;
    bool learns_answer_;
    WheelMotion motion_;
    float answer_per_s_ = 0.0F;
    // Covariance, upper triangle: w speed, t road, a answer.
    float ww_ = 0.0F, wt_ = 0.0F, wa_ = 0.0F, tt_ = 0.0F, ta_ = 0.0F, aa_ = 0.0F;
    float mean_surprise_ = 0.0F;
    float unheard_s_ = 0.0F;  // since a reading was believed
    bool started_ = false;
    bool another_road_ = false;
};

}  // namespace antiskid::control
