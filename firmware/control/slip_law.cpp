#include "firmware/control/slip_law.hpp"

#include "firmware/control/arithmetic.hpp"

namespace antiskid::control {

SlipLaw::SlipLaw(const SlipConfig& config, float period_s) : config_(config), period_s_(period_s) {}

void SlipLaw::start(const Estimate& estimate) {
    reference_ = larger(estimate.slip, 0.0F);
    integral_ = 0.0F;
    building_up_ = true;
    build_up_Pa_ = 0.0F;
}

float SlipLaw::pressure_Pa(const Estimate& e, float slip_reference, float ceiling_Pa) {
    reference_ = towards(reference_, falling_reference(config_, slip_reference, e.late_v_mps),
                         config_.reference_rate_per_s * period_s_);

    // lambda_dot = (r k_b / (J v)) (P - P_balance), from eq. (1b) and (3): slip rate and pressure differ by
    // this factor.
    const float rate_per_Pa = e.radius_m * e.brake_gain / e.late_v_mps;
    const float error = reference_ - e.late_slip;
    const float rate = rate_per_Pa * (e.late_pressure.pressure_Pa - e.balance_Pa);
    const float rate_rate = rate_per_Pa * e.late_pressure.rate_Paps;
    const float wanted_rate =
        config_.k_p_per_s * error + integral_ - config_.k_d * rate - config_.k_dd_s * rate_rate;
    float wanted_Pa = config_.road_torque_share * e.balance_Pa + wanted_rate / rate_per_Pa;

    if (building_up_) {
        building_up_ =
            e.late_slip < config_.build_up_slip * smaller(reference_, config_.build_up_reference_limit);
        build_up_Pa_ =
            smaller(build_up_Pa_ + config_.build_up_rate_Paps * period_s_, config_.build_up_pressure_Pa);
        if (building_up_) wanted_Pa = larger(wanted_Pa, e.balance_Pa + build_up_Pa_);
    }

    const float given_Pa = limited(wanted_Pa, 0.0F, ceiling_Pa);
    // The integral rests while the valve is at a limit and the error would drive it further in, and while
    // pressure builds up.
    const bool winds_up =
        (wanted_Pa > given_Pa && error > 0.0F) || (wanted_Pa < given_Pa && error < 0.0F) || building_up_;
    if (!winds_up) integral_ += config_.k_i_per_s2 * error * period_s_;
    return given_Pa;
}

}  // namespace antiskid::control
