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

/// Of friction over slip, -1 to 1.
float elasticity_of(const Estimate& e) {
    constexpr float kLeastSlip = 0.01F;
    constexpr float kLeastRoad_radps2 = 50.0F;  // less is noise
    const float road = larger(e.road_radps2, kLeastRoad_radps2);
    return limited(e.answer_per_s * larger(e.slip, kLeastSlip) * e.v_mps / (e.radius_m * road), -1.0F, 1.0F);
}
}  // namespace

PeakSeeker::PeakSeeker(const PeakConfig& config, float period_s)
    : config_(config), period_s_(period_s), slip_(config.start_slip) {}

void PeakSeeker::follow(const Estimate& e) {
    if (e.another_road) {
        elasticity_ = 0.0F;
        slip_ = larger(slip_, config_.start_slip);
    }
    elasticity_ += (elasticity_of(e) - elasticity_) * config_.filter_radps * period_s_;
    const float missing = limited(config_.gain * (elasticity_ - config_.elasticity), -1.0F, 1.0F);
    const float falls = e.slip > kNearlyLocked ? config_.lock_fall_per_s : 0.0F;
    slip_ += slip_ * (config_.rate_per_s * missing - falls) * period_s_;
    slip_ = limited(slip_, config_.least_slip, config_.most_slip);
}

float PeakSeeker::reference(const Estimate& e) {
    if (e.v_mps >= config_.least_speed_mps) follow(e);
    phase_ += config_.swing_Hz * period_s_;
    if (phase_ >= 1.0F) phase_ -= 1.0F;
    return smaller(slip_ * (1.0F + config_.swing * triangle(phase_)), config_.most_slip);
}

}  // namespace antiskid::control
