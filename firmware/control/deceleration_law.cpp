#include "firmware/control/deceleration_law.hpp"

#include "firmware/control/arithmetic.hpp"

namespace antiskid::control {

namespace {
constexpr float kHoldMemory_s = 0.1F;
constexpr float kGuardShare = 0.5F;  // of the slip limit
}  // namespace

DecelerationLaw::DecelerationLaw(const DecelerationConfig& config, const SlipConfig& slip, float period_s)
    : config_(config), guard_(slip, period_s), period_s_(period_s) {}

void DecelerationLaw::start(const Estimate& estimate) {
    guard_.start(estimate);
    guard_.forget_runway();
    // The wheel rolls with the aircraft. One reading of its own acceleration is noise of several m/s2, which the filter would
    // take a second to forget.
    measured_mps2_ = larger(-estimate.v_dot_mps2, 0.0F);
    behind_radps_ = measured_mps2_ / (config_.filter_radps * estimate.radius_m);
    omega_before_radps_ = estimate.omega_radps;
    reference_mps2_ = measured_mps2_;
    integral_Pa_ = estimate.pressure.pressure_Pa;
    held_Pa_ = estimate.pressure.pressure_Pa;
}

/// Far from the limit the guard is inactive: its integral would wind up, and at low speed the noise of the road torque would make it reduce the
/// pressure.
float DecelerationLaw::guarded_Pa(const Estimate& e, float ceiling_Pa) {
    if (e.late_slip > kGuardShare * config_.slip_limit) return guard_.pressure_Pa(e, config_.slip_limit, ceiling_Pa);
    guard_.start(e);
    return ceiling_Pa;
}

float DecelerationLaw::pressure_Pa(const Estimate& e, float deceleration_mps2, float ceiling_Pa) {
    // The filter differentiates the speed itself: its integral over a build-up is the speed lost. The estimator's acceleration follows the brake
    // sooner than the road, and its integral is larger.
    const float gain = config_.filter_radps * period_s_ / (1.0F + config_.filter_radps * period_s_);
    behind_radps_ = (behind_radps_ + omega_before_radps_ - e.omega_radps) * (1.0F - gain);
    omega_before_radps_ = e.omega_radps;
    measured_mps2_ = config_.filter_radps * behind_radps_ * e.radius_m;
    // Too slow for the encoders: the last pressure is held to standstill. Its mean, since the slip guard may just have let go.
    if (e.v_mps < config_.drop_out_mps) return limited(held_Pa_, 0.0F, ceiling_Pa);
    const float allowed_Pa = guarded_Pa(e, ceiling_Pa);

    reference_mps2_ = towards(reference_mps2_, deceleration_mps2, config_.onset_mps3 * period_s_);
    const float error = reference_mps2_ - measured_mps2_;
    const float wanted_Pa = integral_Pa_ + config_.k_p_Pa_per_mps2 * error;
    const float given_Pa = limited(wanted_Pa, 0.0F, allowed_Pa);
    const bool winds_up = (wanted_Pa > given_Pa && error > 0.0F) || (wanted_Pa < given_Pa && error < 0.0F);
    if (!winds_up) integral_Pa_ += config_.k_i_Pa_per_m_per_s * error * period_s_;
    integral_Pa_ = limited(integral_Pa_, 0.0F, allowed_Pa);
    held_Pa_ += (given_Pa - held_Pa_) * period_s_ / (kHoldMemory_s + period_s_);
    return given_Pa;
}

}  // namespace antiskid::control
