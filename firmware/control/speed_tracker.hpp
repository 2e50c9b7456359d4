/// Speed and acceleration from speed readings that come late and irregularly: a critically damped
/// second-order tracker.
#pragma once

#include "firmware/control/config.hpp"
#include "firmware/control/speed_estimator.hpp"

namespace antiskid::control {

class SpeedTracker {
  public:
    /// The encoder's largest acceleration, either way: readings that are off the prediction by more than twice what it explains are not believed for
    /// its patience, and no reading, however wrong, may leave a state from which the next ones do not lead back.
    SpeedTracker(float bandwidth_radps, const EncoderConfig& encoder);

    /// One period of `period_s` has passed. Acceleration is taken to change slowly.
    void update(const SpeedReading& reading, float period_s);
    void reset(float speed, float acceleration);

    [[nodiscard]] float speed() const { return speed_; }
    [[nodiscard]] float acceleration() const { return acceleration_; }

  private:
    float bandwidth_radps_;
    float max_speed_;
    float max_acceleration_;
    float patience_s_;
    float speed_ = 0.0F;
    float acceleration_ = 0.0F;
    float unheard_s_ = 0.0F;  // since a reading was believed
    bool started_ = false;
};

}  // namespace antiskid::control
