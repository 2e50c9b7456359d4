#include "firmware/control/peak_seeker.hpp"

#include "firmware/control/arithmetic.hpp"

namespace antiskid::control {

namespace {
constexpr float kNearlyLocked = 0.6F;

/// -1 to 1, a triangle that begins at 0 and rises.
float triangle(float turns) {
    if (turns < 0.25F) return 4.0F * turns;
    return turns < 0.75F ? 2.0F - 4.0F * turns : 4.0F * turns - 4.0F;
}

/// Of friction over slip, per pole of the wheel.
float elasticity_per_pole_s(const Estimate& e) {
    constexpr float kMinSlip = 0.01F;
    constexpr float kMinRoad_radps2 = 50.0F;  // less is noise
    const float road = larger(e.road_radps2, kMinRoad_radps2);
    return larger(e.slip, kMinSlip) * e.v_mps / (e.radius_m * road);
}
}  // namespace

PeakSeeker::PeakSeeker(const PeakConfig& config, float inertia_kgm2, float period_s)
    : config_(config), inertia_kgm2_(inertia_kgm2), period_s_(period_s), slip_(config.start_slip) {}

void PeakSeeker::follow(const Estimate& e) {
    if (e.another_road) {
        elasticity_ = 0.0F;
        slip_ = larger(slip_, config_.start_slip);
    }
    const float per_pole_s = elasticity_per_pole_s(e);
    const float share = config_.filter_radps * period_s_;
    elasticity_ += (limited(e.wheel_pole_radps * per_pole_s, -1.0F, 1.0F) - elasticity_) * share;
    const float at_peak = 1.0F - magnitude(elasticity_);
    const float known = 1.0F / (1.0F + e.wheel_pole_variance_radps2 * per_pole_s * per_pole_s);
    confidence_ += (at_peak * known - confidence_) * share;
    grip_N_ += (inertia_kgm2_ * e.road_radps2 / e.radius_m - grip_N_) * at_peak * share;
    const float missing = limited(config_.gain * (elasticity_ - config_.elasticity), -1.0F, 1.0F);
    const float falls = e.slip > kNearlyLocked ? config_.lock_fall_per_s : 0.0F;
    slip_ += slip_ * (config_.rate_per_s * missing - falls) * period_s_;
    slip_ = limited(slip_, config_.min_slip, config_.max_slip);
}

float PeakSeeker::reference(const Estimate& e) {
    if (e.v_mps >= config_.min_speed_mps) follow(e);
    phase_ += config_.swing_Hz * period_s_;
    if (phase_ >= 1.0F) phase_ -= 1.0F;
    return smaller(slip_ * (1.0F + config_.swing * triangle(phase_)), config_.max_slip);
}

}  // namespace antiskid::control
