/// Estimates the braked wheel's speed, the road torque and the pole of slip: an extended Kalman filter on encoder readings and brake torque.
///
/// State, all of the wheel: omega (rad/s); tau = r F_x / J_w (rad/s2); the wheel's pole a (rad/s), which is the slip damping of tyre and road over
/// J_w: slip returns to its equilibrium as exp(-a t). With u = k_b P / J_w, and omega v_dot / v, the wheel acceleration at constant slip, eq. (1b)
/// and (3) give
///
///     omega_dot = tau - u        tau_dot = a (u + omega v_dot / v - tau)        a = F_z r^2 mu'(lambda) / (J_w v)
///
/// a is large and positive (stable) if friction rises steeply with slip and the speed is low, 0 at the peak, negative beyond it: the wheel then
/// runs away as exp(|a| t).
#pragma once

#include "firmware/control/arithmetic.hpp"
#include "firmware/control/config.hpp"
#include "firmware/control/speed_estimator.hpp"
#include "firmware/control/turn_line.hpp"

namespace antiskid::control {

/// State of the wheel, now or predicted.
struct WheelMotion {
    float omega_radps = 0.0F;
    float road_radps2 = 0.0F;  ///< tau
};

/// One step of the equations above with constant inputs. Implicit for a restoring road (a > 0), which is stable for any step; otherwise explicit.
class WheelStep {
  public:
    WheelStep(float wheel_pole_radps, float step_s)
        : wheel_pole_radps_(wheel_pole_radps),
          step_s_(step_s),
          acting_s_(wheel_pole_radps > 0.0F ? step_s / (1.0F + wheel_pole_radps * step_s) : step_s) {}

    [[nodiscard]] WheelMotion from(const WheelMotion& at, float brake_radps2, float steady_radps2) const {
        const float change = acting_s_ * (at.road_radps2 - brake_radps2 - steady_radps2);
        return {larger(at.omega_radps + change + steady_radps2 * step_s_, 0.0F), at.road_radps2 - wheel_pole_radps_ * change};
    }
    /// Effective duration, s, for which a torque imbalance acts within the step.
    [[nodiscard]] float acting_s() const { return acting_s_; }

  private:
    float wheel_pole_radps_;
    float step_s_;
    float acting_s_;
};

class WheelObserver {
  public:
    WheelObserver(const ObserverConfig& config, const WheelConfig& wheel, float period_s);

    /// Inputs of a period, as accelerations of the wheel.
    struct Drive {
        float brake_radps2 = 0.0F;      ///< k_b P / J_w, mean over the period
        float brake_now_radps2 = 0.0F;  ///< at its end
        float steady_radps2 = 0.0F;     ///< omega v_dot / v
    };
    /// One period. An invalid reading or a wheel at standstill restarts the filter. An impossible reading is ignored; it restarts the filter once
    /// EncoderConfig::reject_timeout_s has passed since the last accepted one. Readings that deviate persistently to one side mean another road, and
    /// the learnt pole is discarded.
    void update(const SpeedReading& reading, const Drive& drive);

    [[nodiscard]] const WheelMotion& motion() const { return motion_; }
    [[nodiscard]] float wheel_pole_radps() const { return wheel_pole_radps_; }
    [[nodiscard]] float wheel_pole_variance_radps2() const { return aa_; }
    /// Whether the last update found another road.
    [[nodiscard]] bool another_road() const { return another_road_; }

  private:
    void begin(float omega_radps);
    void predict(const Drive& drive);
    void correct(const SpeedReading& reading, const Drive& drive);
    [[nodiscard]] bool is_another_road(float innovation, float since_s, float variance);
    void forget_road(float reading_variance);

    ObserverConfig config_;
    float max_radps_;
    float max_radps2_;
    float reading_noise_rad_;      // of an edge's place
    float road_variance_;          // that a period adds
    float max_mean_innovation_2_;  // its square
    float reject_timeout_s_;
    float hardest_brake_;
    float period_s_;
    bool learns_pole_;
    WheelMotion motion_;
    float wheel_pole_radps_ = 0.0F;
    // Covariance, upper triangle: w speed, t road, a pole.
    float ww_ = 0.0F, wt_ = 0.0F, wa_ = 0.0F, tt_ = 0.0F, ta_ = 0.0F, aa_ = 0.0F;
    float mean_innovation_ = 0.0F;
    TurnLine line_;
    float since_accepted_s_ = 0.0F;
    bool started_ = false;
    bool another_road_ = false;
};

}  // namespace antiskid::control
