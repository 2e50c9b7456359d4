#include "firmware/control/slip_law.hpp"

namespace antiskid::control {

namespace {
/// The wheel's pole along the chord of friction from no slip, r tau / (lambda v): a wheel that follows the pressure at once, as one with
/// hardly any slip does, shows no slope by its speed, but its torque over its slip.
float chord_per_s(const Estimate& e) {
    constexpr float kMinSlip = 0.01F;  // less is the error of the wheel's radius
    return larger(e.road_radps2, 0.0F) * e.radius_m / (larger(e.slip, kMinSlip) * e.late_v_mps);
}
}  // namespace

SlipLaw::SlipLaw(const SlipConfig& config, float period_s)
    : config_(config),
      period_s_(period_s),
      reference_step_(config.reference_rate_per_s * period_s),
      min_share_(config.earliest_peak_slip / kMaxSlipReference),
      early_rate_per_s_(config.early_slip_rate_per_s - config.max_slip_rate_per_s) {}

void SlipLaw::start(const Estimate& estimate) {
    reference_ = larger(estimate.slip, 0.0F);
    scheduled_reference_ = reference_;
    integral_ = 0.0F;
    wheel_pole_radps_ = estimate.wheel_pole_radps;
    slip_error_ = 0.0F;
}

/// Lowers the reference for slip that stays above it, the sign of a hunting loop or a locking wheel on any road. The floor takes the largest
/// reference to the earliest peak of friction; every smaller reference then ends before that peak.
void SlipLaw::retreat(const Estimate& e, float rate_per_s) {
    const float excess = larger(e.slip - reference_ - kHeldWithin, 0.0F);
    share_ = limited(share_ + (rate_per_s - config_.excess_fall_per_s * excess) * period_s_, min_share_, 1.0F);
}

/// Increases the share of the reference while the road is restoring, reduces it while the wheel runs away.
float SlipLaw::rate_by_pole_per_s(const Estimate& e) {
    wheel_pole_radps_ += (e.wheel_pole_radps - wheel_pole_radps_) * config_.pole_filter_radps * period_s_;
    const float wanted = (wheel_pole_radps_ + config_.runaway_per_s) / config_.pole_scale_radps;
    slip_error_ += (magnitude(e.slip - reference_) - slip_error_) * config_.pole_filter_radps * period_s_;
    const bool may_fall = wanted > 0.0F || slip_error_ >= config_.max_held_slip_error;
    return may_fall ? smaller(wanted, 1.0F) * config_.rise_per_s : 0.0F;
}

float SlipLaw::pressure_Pa(const Estimate& e, float slip_reference, float ceiling_Pa) {
    retreat(e, rate_by_pole_per_s(e));
    return hold_Pa(e, falling_reference(config_, slip_reference, e.late_v_mps), share_ * slip_reference, ceiling_Pa);
}

float SlipLaw::follow_Pa(const Estimate& e, float slip_reference, float ceiling_Pa) {
    retreat(e, config_.rise_per_s);
    return hold_Pa(e, falling_reference(config_, slip_reference, e.late_v_mps), share_ * slip_reference, ceiling_Pa);
}

/// 1 without slip, 0 from the slip on at which a runway's friction may have its peak.
float SlipLaw::earliness(float slip) const {
    return limited(1.0F - slip / config_.earliest_peak_slip, 0.0F, 1.0F);
}

float SlipLaw::hold_Pa(const Estimate& e, float falling, float allowed, float ceiling_Pa) {
    reference_ = towards(reference_, smaller(falling, allowed), reference_step_);
    scheduled_reference_ = larger(reference_, falling);

    // lambda_dot = (r k_b / (J v)) (P - P_balance), from eq. (1b) and (3): slip rate and pressure differ by this factor.
    const float rate_per_Pa = e.radius_m * e.brake_gain / e.late_v_mps;
    const float error = reference_ - e.late_slip;
    const float rate = rate_per_Pa * (e.late_pressure.pressure_Pa - e.late_balance_Pa);
    const float rate_rate = rate_per_Pa * e.late_pressure.rate_Paps;
    const float early = earliness(e.slip);
    const float along_chord = early > 0.0F ? early * chord_per_s(e) : 0.0F;
    const float restoring = larger(config_.k_pole * larger(e.wheel_pole_radps, 0.0F), along_chord);
    const float max_rate = config_.max_slip_rate_per_s + early * early_rate_per_s_;
    const float wanted_rate = (config_.k_p_per_s + restoring) * error + integral_ - config_.k_d * rate - config_.k_dd_s * rate_rate;
    const float wanted_Pa = e.late_balance_Pa + smaller(wanted_rate, max_rate) / rate_per_Pa;
    const float given_Pa = limited(wanted_Pa, 0.0F, ceiling_Pa);
    // The integral is held while slip rate or valve is at a limit and the error would drive it further (anti-windup).
    const bool winds_up = ((wanted_rate > max_rate || wanted_Pa > given_Pa) && error > 0.0F) || (wanted_Pa < given_Pa && error < 0.0F);
    if (!winds_up) integral_ += config_.k_i_per_s2 * error * period_s_;
    return given_Pa;
}

}  // namespace antiskid::control
