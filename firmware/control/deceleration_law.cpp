#include "firmware/control/deceleration_law.hpp"

#include "firmware/control/arithmetic.hpp"

namespace antiskid::control {

DecelerationLaw::DecelerationLaw(const DecelerationConfig& config, const SlipConfig& slip, float period_s)
    : config_(config), guard_(slip, period_s), period_s_(period_s) {}

void DecelerationLaw::start(const Estimate& estimate) {
    guard_.start(estimate);
    measured_mps2_ = larger(-estimate.omega_dot_radps2 * estimate.radius_m, 0.0F);
    reference_mps2_ = measured_mps2_;
    integral_Pa_ = estimate.pressure.pressure_Pa;
}

float DecelerationLaw::pressure_Pa(const Estimate& e, float deceleration_mps2, float ceiling_Pa) {
    const float gain = config_.filter_radps * period_s_ / (1.0F + config_.filter_radps * period_s_);
    measured_mps2_ += gain * (-e.omega_dot_radps2 * e.radius_m - measured_mps2_);
    // Too slow for the encoders: the last pressure is held to standstill.
    if (e.v_mps < config_.drop_out_mps) return limited(integral_Pa_, 0.0F, ceiling_Pa);
    const float allowed_Pa = guard_.pressure_Pa(e, config_.slip_limit, ceiling_Pa);

    reference_mps2_ = towards(reference_mps2_, deceleration_mps2, config_.onset_mps3 * period_s_);
    const float error = reference_mps2_ - measured_mps2_;
    const float wanted_Pa = integral_Pa_ + config_.k_p_Pa_per_mps2 * error;
    const float given_Pa = limited(wanted_Pa, 0.0F, allowed_Pa);
    const bool winds_up = (wanted_Pa > given_Pa && error > 0.0F) || (wanted_Pa < given_Pa && error < 0.0F);
    if (!winds_up) integral_Pa_ += config_.k_i_Pa_per_m_per_s * error * period_s_;
    integral_Pa_ = limited(integral_Pa_, 0.0F, allowed_Pa);
    return given_Pa;
}

}  // namespace antiskid::control
