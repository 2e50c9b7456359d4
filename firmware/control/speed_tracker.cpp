#include "firmware/control/speed_tracker.hpp"

#include "firmware/control/arithmetic.hpp"

namespace antiskid::control {

SpeedTracker::SpeedTracker(float bandwidth_radps, const EncoderConfig& encoder)
    : bandwidth_radps_(bandwidth_radps),
      max_speed_(encoder.max_speed_radps),
      max_acceleration_(encoder.max_acceleration_radps2),
      reject_timeout_s_(encoder.reject_timeout_s) {}

void SpeedTracker::reset(float speed, float acceleration) {
    speed_ = speed;
    acceleration_ = acceleration;
    since_accepted_s_ = 0.0F;
    started_ = true;
}

void SpeedTracker::update(const SpeedReading& reading, float period_s) {
    if (!reading.valid) {
        reset(0.0F, 0.0F);
        started_ = false;
        return;
    }
    const bool possible = is_possible(reading, max_speed_);
    if (!started_) {
        if (reading.fresh && possible) reset(reading.speed_radps, 0.0F);
        return;
    }
    const float predicted = speed_ + acceleration_ * period_s;
    speed_ = larger(predicted, 0.0F);
    since_accepted_s_ += period_s;
    if (reading.speed_radps == 0.0F && reading.fresh) {
        reset(0.0F, 0.0F);
        return;
    }
    if (!possible) return;
    const bool slower_than_believed = reading.bounded && reading.speed_radps < speed_;
    if (!reading.fresh && !slower_than_believed) return;

    // The reading is the mean over its interval: compare it with the speed at the interval's middle. The last
    // edge came on average half a period, or half an interval where that is shorter, before the sample.
    // Where the prediction stops at zero, the wheel did not come along that line: looking back along it would
    // find the reading explained and leave the speed at zero.
    const float age = 0.5F * (reading.interval_s + smaller(reading.interval_s, period_s));
    const float since_middle = predicted > 0.0F ? acceleration_ * age : 0.0F;
    const float innovation = reading.speed_radps - (speed_ - since_middle);
    const float since = larger(reading.interval_s, period_s);
    constexpr float kTwice = 2.0F;  // the prediction may be as far off as the reading
    if (since_accepted_s_ < reject_timeout_s_ && magnitude(innovation) > kTwice * max_acceleration_ * since) return;
    since_accepted_s_ = 0.0F;
    const float memory = 1.0F / (1.0F + bandwidth_radps_ * since);
    speed_ = larger(speed_ + (1.0F - memory * memory) * innovation, 0.0F);
    acceleration_ = limited(acceleration_ + (1.0F - memory) * (1.0F - memory) * innovation / since, -max_acceleration_, max_acceleration_);
}

}  // namespace antiskid::control
