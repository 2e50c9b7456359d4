#include "firmware/control/threshold_law.hpp"

#include "firmware/control/arithmetic.hpp"

namespace antiskid::control {

ThresholdLaw::ThresholdLaw(const ThresholdConfig& config, float period_s) : config_(config), period_s_(period_s) {}

void ThresholdLaw::start(const Estimate& estimate) {
    action_ = Action::increase;
    skidded_ = false;
    pressure_ = estimate.pressure.pressure_Pa;
}

float ThresholdLaw::pressure_Pa(const Estimate& e, float ceiling_Pa) {
    const float rim_acceleration = e.omega_dot_radps2 * e.radius_m;
    const bool skids = e.slip > config_.slip_high || (rim_acceleration < -config_.deceleration_high_mps2 && e.slip > config_.slip_low);
    const bool recovers = rim_acceleration > config_.acceleration_high_mps2;
    const bool recovered = e.slip < config_.slip_low;

    if (action_ != Action::decrease && skids && !recovers) {
        action_ = Action::decrease;
        skidded_ = true;
        skid_Pa_ = e.pressure.pressure_Pa;
    } else if (action_ == Action::decrease && (recovers || recovered)) {
        action_ = Action::hold;
    }
    if (action_ == Action::hold && recovered) {
        action_ = Action::increase;
        pressure_ = larger(pressure_, config_.restore_share * skid_Pa_);
    }

    if (action_ == Action::increase) pressure_ += (skidded_ ? config_.rise_Paps : config_.first_rise_Paps) * period_s_;
    if (action_ == Action::decrease) pressure_ -= config_.fall_Paps * period_s_;
    pressure_ = limited(pressure_, 0.0F, ceiling_Pa);
    return pressure_;
}

}  // namespace antiskid::control
