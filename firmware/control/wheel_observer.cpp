#include "firmware/control/wheel_observer.hpp"

namespace antiskid::control {

namespace {
constexpr float kFullTurn = 6.28318531F;
constexpr float kMinNoise_radps = 0.02F;  // of a reading: the clock's resolution
constexpr float kMinPole_radps = -60.0F;  // faster than this no valve can follow, and a wild reading must not lead there
constexpr float kMaxPole_radps = 6000.0F;
constexpr float kMinTurn_radps = 15.0F;  // slower, a line at the wheel's turns cannot be told from the rest
}  // namespace

WheelObserver::WheelObserver(const ObserverConfig& config, const WheelConfig& wheel, float period_s)
    : config_(config),
      max_radps_(wheel.encoder.max_speed_radps),
      max_radps2_(wheel.encoder.max_acceleration_radps2),
      reading_noise_rad_(config.reading_noise * (kFullTurn / wheel.encoder.teeth)),
      road_variance_(config.road_noise_radps2 * config.road_noise_radps2 * period_s),
      max_mean_innovation_2_(config.max_mean_innovation * config.max_mean_innovation),
      reject_timeout_s_(wheel.encoder.reject_timeout_s),
      hardest_brake_(wheel.hardest_brake),
      period_s_(period_s),
      learns_pole_(config.pole_noise > 0.0F) {}

void WheelObserver::begin(float omega_radps) {
    constexpr float kSpeed_radps = 10.0F, kRoad_radps2 = 100.0F;
    motion_ = {omega_radps, 0.0F};
    wheel_pole_radps_ = 0.5F * config_.pole_floor_radps;
    ww_ = kSpeed_radps * kSpeed_radps;
    tt_ = kRoad_radps2 * kRoad_radps2;
    aa_ = learns_pole_ ? wheel_pole_radps_ * wheel_pole_radps_ : 0.0F;
    wt_ = 0.0F;
    wa_ = 0.0F;
    ta_ = 0.0F;
    mean_innovation_ = 0.0F;
    since_accepted_s_ = 0.0F;
}

void WheelObserver::predict(const Drive& drive) {
    constexpr float kSpeedNoise = 1.0F;   // rad/s in the root of a second: what the equations leave out
    constexpr float kMaxVariance = 4e7F;  // of the pole
    const float h = period_s_;
    const WheelStep step(wheel_pole_radps_, h);
    const float f = step.acting_s();
    const float excess = motion_.road_radps2 - drive.brake_radps2 - drive.steady_radps2;
    motion_ = step.from(motion_, drive.brake_radps2, drive.steady_radps2);
    motion_.road_radps2 = limited(motion_.road_radps2, -max_radps2_, max_radps2_);

    // F = [1 f w_a; 0 1 - a f t_a; 0 0 1], then F P F^T + Q.
    const float w_a = wheel_pole_radps_ > 0.0F ? -f * f * excess : 0.0F;
    const float t_a = -f * f / h * excess;
    const float keeps = 1.0F - wheel_pole_radps_ * f;
    const float ww = ww_ + f * wt_ + w_a * wa_;
    const float wt = wt_ + f * tt_ + w_a * ta_;
    const float wa = wa_ + f * ta_ + w_a * aa_;
    const float tt = keeps * tt_ + t_a * ta_;
    const float ta = keeps * ta_ + t_a * aa_;
    const float pole_noise = config_.pole_noise * (magnitude(wheel_pole_radps_) + config_.pole_floor_radps);
    ww_ = ww + f * wt + w_a * wa + kSpeedNoise * kSpeedNoise * h;
    wt_ = keeps * wt + t_a * wa;
    wa_ = wa;
    tt_ = keeps * tt + t_a * ta + road_variance_;
    ta_ = ta;
    if (aa_ < kMaxVariance) aa_ += pole_noise * pole_noise * h;
}

/// Whether readings deviate to one side for longer than noise explains.
bool WheelObserver::is_another_road(float innovation, float since_s, float variance) {
    constexpr float kMemory_s = 0.008F;
    mean_innovation_ += (innovation - mean_innovation_) * since_s / (kMemory_s + since_s);
    const float of_mean = variance * since_s / (2.0F * kMemory_s);
    return mean_innovation_ * mean_innovation_ > max_mean_innovation_2_ * of_mean;
}

void WheelObserver::forget_road(float reading_variance) {
    constexpr float kRoad_radps2 = 2000.0F;
    another_road_ = true;
    mean_innovation_ = 0.0F;
    wheel_pole_radps_ = 0.5F * config_.pole_floor_radps;
    ww_ += reading_variance;
    tt_ += kRoad_radps2 * kRoad_radps2;
    aa_ = learns_pole_ ? config_.pole_floor_radps * config_.pole_floor_radps : 0.0F;
    wt_ = 0.0F;
    wa_ = 0.0F;
    ta_ = 0.0F;
}

void WheelObserver::correct(const SpeedReading& reading, const Drive& drive) {
    // The reading is the mean over its interval, which ended half a period ago on average: omega - age (tau - u).
    const float age = 0.5F * (reading.interval_s + smaller(reading.interval_s, period_s_));
    const float rate = motion_.omega_radps > 0.0F ? motion_.road_radps2 - drive.brake_now_radps2 : 0.0F;
    const float innovation = reading.speed_radps - (motion_.omega_radps - rate * age);
    const float since = larger(reading.interval_s, period_s_);
    const float noise = reading_noise_rad_ / since;
    // A wheel slows by brake torque alone, or by what that or the road have wound up in a carcass: a gap where teeth are missing is no slip.
    constexpr float kWild = 4.0F;  // standard deviations: chance alone takes one sound reading in 16,000 there
    const float acts_radps2 = innovation < 0.0F ? larger(drive.brake_now_radps2, motion_.road_radps2) : max_radps2_;
    if (magnitude(innovation) > hardest_brake_ * acts_radps2 * since + kWild * noise) {
        if (since_accepted_s_ >= reject_timeout_s_) begin(reading.speed_radps);
        return;
    }
    since_accepted_s_ = 0.0F;
    const float variance = noise * noise + kMinNoise_radps * kMinNoise_radps;
    if (is_another_road(innovation, since, ww_ - 2.0F * age * wt_ + age * age * tt_ + variance)) forget_road(variance);
    const float w = ww_ - age * wt_, t = wt_ - age * tt_, a = wa_ - age * ta_;
    const float per_variance = 1.0F / (w - age * t + variance);
    const float k_w = w * per_variance, k_t = t * per_variance;
    // An upper bound only shows that the wheel is slower. Used as a reading of an accelerating wheel it would be late, and explained by an ever
    // larger pole of the wheel.
    const float k_a = reading.fresh ? a * per_variance : 0.0F;
    // A torque that comes with every turn of the discs moves the slip, and is taken for road torque that moves against it: a road beyond its peak.
    const bool turns = reading.fresh && motion_.omega_radps > kMinTurn_radps;
    const float of_road = turns ? line_.without(innovation, reading.speed_radps * reading.interval_s, since) : innovation;
    // From rest at a constant acceleration the speed at the end is twice the mean: an uncertain road must not lead to a larger correction.
    const float at_most = larger(motion_.omega_radps, 2.0F * reading.speed_radps);
    motion_.omega_radps = limited(motion_.omega_radps + k_w * innovation, 0.0F, at_most);
    motion_.road_radps2 = limited(motion_.road_radps2 + k_t * innovation, -max_radps2_, max_radps2_);
    wheel_pole_radps_ = limited(wheel_pole_radps_ + k_a * of_road, kMinPole_radps, kMaxPole_radps);
    // Rounding must not make a variance negative.
    ww_ = larger(ww_ - k_w * w, 1e-6F);
    wt_ -= k_w * t;
    wa_ -= k_w * a;
    tt_ = larger(tt_ - k_t * t, 1.0F);
    ta_ -= k_t * a;
    aa_ = larger(aa_ - k_a * a, 1e-3F);
}

void WheelObserver::update(const SpeedReading& reading, const Drive& drive) {
    another_road_ = false;
    if (!reading.valid) {
        begin(0.0F);
        started_ = false;
        return;
    }
    const bool possible = is_possible(reading, max_radps_);
    if (!started_) {
        if (!reading.fresh || !possible) return;
        begin(reading.speed_radps);
        started_ = true;
        return;
    }
    if (reading.speed_radps == 0.0F && reading.fresh) {
        begin(0.0F);
        return;
    }
    predict(drive);
    since_accepted_s_ += period_s_;
    if (possible && (reading.fresh || (reading.bounded && reading.speed_radps < motion_.omega_radps))) correct(reading, drive);
}

}  // namespace antiskid::control
