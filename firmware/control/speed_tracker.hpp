/// Estimates speed and acceleration from late and irregular speed readings: a critically damped second-order tracker.
#pragma once

#include "firmware/control/config.hpp"
#include "firmware/control/speed_estimator.hpp"

namespace antiskid::control {

class SpeedTracker {
  public:
    /// Acceleration is limited to the encoder's. Readings off the prediction by more than twice what that allows are ignored for
    /// EncoderConfig::reject_timeout_s, so that no wrong reading leads to a state from which the following ones cannot recover.
    SpeedTracker(float bandwidth_radps, const EncoderConfig& encoder);

    /// One period of `period_s` has passed. Assumes that acceleration changes slowly.
    void update(const SpeedReading& reading, float period_s);
    void reset(float speed, float acceleration);

    [[nodiscard]] float speed() const { return speed_; }
    [[nodiscard]] float acceleration() const { return acceleration_; }

  private:
    float bandwidth_radps_;
    float max_speed_;
    float max_acceleration_;
    float reject_timeout_s_;
    float speed_ = 0.0F;
    float acceleration_ = 0.0F;
    float since_accepted_s_ = 0.0F;
    bool started_ = false;
};

}  // namespace antiskid::control
