/// Speed and acceleration from speed readings that come late and irregularly: a critically damped
/// second-order tracker.
#pragma once

#include "firmware/control/speed_estimator.hpp"

namespace antiskid::control {

class SpeedTracker {
  public:
    /// `most_acceleration`, either way: readings that are off the prediction by more than twice what it explains are not believed for 10 ms,
    /// and no reading, however wrong, may leave a state from which the next ones do not lead back.
    SpeedTracker(float bandwidth_radps, float most_acceleration);

    /// One period of `period_s` has passed, in which a known cause changed the speed by `impulse` (0: none
    /// known). `known_rate` is that cause's acceleration now. What is left is tracked as a slowly changing
    /// acceleration.
    void update(const SpeedReading& reading, float period_s, float impulse, float known_rate);
    void reset(float speed, float acceleration);

    [[nodiscard]] float speed() const { return speed_; }
    [[nodiscard]] float acceleration() const { return acceleration_; }  ///< without the known cause

  private:
    float bandwidth_radps_;
    float most_acceleration_;
    float speed_ = 0.0F;
    float acceleration_ = 0.0F;
    float unheard_s_ = 0.0F;  // since a reading was believed
    bool started_ = false;
};

}  // namespace antiskid::control
