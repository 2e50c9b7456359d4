/// Computes an Estimate from checked sensor values: speeds by the M/T method, rolling radius, road torque, valve state, prediction over the delay.
#pragma once

#include "firmware/control/config.hpp"
#include "firmware/control/estimate.hpp"
#include "firmware/control/speed_tracker.hpp"
#include "firmware/control/types.hpp"
#include "firmware/control/wheel_observer.hpp"

namespace antiskid::control {

class Estimator {
  public:
    explicit Estimator(const Config& config);

    /// One period; `held_Pa` is the static pressure, by the map, for the current that the valve has held since the last step.
    const Estimate& update(const Sensors& sensors, float held_Pa);

    [[nodiscard]] const Estimate& estimate() const { return estimate_; }
    [[nodiscard]] const SpeedReading& wheel_reading() const { return wheel_reading_; }
    [[nodiscard]] const SpeedReading& flywheel_reading() const { return flywheel_reading_; }
    [[nodiscard]] float uncorrected_pressure_Pa() const { return valve_model_.uncorrected_Pa(); }
    [[nodiscard]] float valve_offset_Pa() const { return valve_model_.offset_Pa(); }
    /// Pressure to look up in the map so that the valve, with its learnt offset, gives `pressure_Pa`.
    [[nodiscard]] float compensated_Pa(float pressure_Pa) const { return valve_model_.compensated_Pa(pressure_Pa); }

  private:
    void calibrate_radius(bool on_wheels);
    void look_ahead(float v_mps);

    WheelConfig wheel_;
    float max_reading_Pa_;
    float free_Pa_;  // below it the wheel counts as rolling freely
    float calibrates_above_mps_;
    float flywheel_radius_m_;
    float period_s_;
    float brake_gain_;  // k_b / J_w
    float half_gain_;   // for a mean of two pressures
    float lift_per_stiffness_;
    SpeedEstimator wheel_speed_;
    SpeedEstimator flywheel_speed_;
    WheelObserver wheel_observer_;
    float prediction_share_;
    float steady_radps2_ = 0.0F;  // omega v_dot / v: of a wheel that keeps its slip
    SpeedTracker flywheel_tracker_;
    ValveModel valve_model_;
    Time pressure_received_ = kNever;
    float standing_radius_m_;  // r at v = 0: r(v) = standing radius + lift v^2 / k_r
    SpeedReading wheel_reading_;
    SpeedReading flywheel_reading_;
    Estimate estimate_;
};

}  // namespace antiskid::control
