#include "firmware/control/pressure_bias_law.hpp"

#include "firmware/control/arithmetic.hpp"

namespace antiskid::control {

PressureBiasLaw::PressureBiasLaw(const PressureBiasConfig& config, float period_s) : config_(config), period_s_(period_s) {}

void PressureBiasLaw::start(const Estimate& estimate) {
    skidded_ = false;
    laid_up_ = false;
    start_Pa_ = estimate.pressure.pressure_Pa;
    reference_mps_ = estimate.omega_radps * estimate.radius_m;
}

void PressureBiasLaw::resume(const Estimate& estimate) {
    if (!laid_up_) start(estimate);
    skidded_ = true;
    reference_mps_ = estimate.omega_radps * estimate.radius_m;
}

float PressureBiasLaw::pressure_Pa(const Estimate& e, float ceiling_Pa) {
    const float rim_mps = e.omega_radps * e.radius_m;
    reference_mps_ = larger(rim_mps, reference_mps_ - config_.reference_fall_mps2 * period_s_);
    const float error_mps = larger(reference_mps_ - rim_mps - config_.dead_band_mps, 0.0F);
    const float lead_mps2 = larger(-e.omega_dot_radps2 * e.radius_m - config_.lead_dead_band_mps2, 0.0F);

    if (!laid_up_) bias_Pa_ = ceiling_Pa - start_Pa_;
    laid_up_ = true;
    if (error_mps > 0.0F) {
        skidded_ = true;
        bias_Pa_ += config_.k_bias_Pa_per_m * error_mps * period_s_;
    } else {
        bias_Pa_ -= (skidded_ ? config_.bleed_Paps : config_.first_bleed_Paps) * period_s_;
    }
    bias_Pa_ = limited(bias_Pa_, 0.0F, config_.max_bias_share * ceiling_Pa);

    const float transient_Pa = config_.k_transient_Pa_per_mps * error_mps;
    const float lead_Pa = config_.k_lead_Pa_per_mps2 * lead_mps2;
    return limited(ceiling_Pa - bias_Pa_ - transient_Pa - lead_Pa, 0.0F, ceiling_Pa);
}

}  // namespace antiskid::control
