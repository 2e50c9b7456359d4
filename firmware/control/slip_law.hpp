/// The wheel-slip law of Section V: PID on slip, predicted over the valve's delay, on top of the pressure that balances the road. Its gain grows with
/// the wheel's pole. It lowers its reference towards the peak of friction when the wheel runs away faster than the valve can follow, or the
/// slip stays above the reference.
#pragma once

#include "firmware/control/arithmetic.hpp"
#include "firmware/control/config.hpp"
#include "firmware/control/estimate.hpp"

namespace antiskid::control {

/// `slip_reference`, reduced below SlipConfig::low_speed_mps.
[[nodiscard]] constexpr float falling_reference(const SlipConfig& config, float slip_reference, float speed_mps) {
    if (speed_mps >= config.low_speed_mps) return slip_reference;
    const float low = smaller(slip_reference, config.low_speed_slip);
    const float share = limited((speed_mps - config.low_speed_floor_mps) / (config.low_speed_mps - config.low_speed_floor_mps), 0.0F, 1.0F);
    return low + share * (slip_reference - low);
}

/// Largest reference that is accepted.
inline constexpr float kMaxSlipReference = 0.5F;

/// Deviation from the reference within which a healthy loop holds the slip.
inline constexpr float kHeldWithin = 0.05F;

class SlipLaw {
  public:
    SlipLaw(const SlipConfig& config, float period_s);

    /// Starts from rest at the present slip. Keeps the learnt share of the reference.
    void start(const Estimate& estimate);
    /// For another landing: the whole reference applies again.
    void forget_runway() { share_ = 1.0F; }

    /// Pressure to request, 0 to `ceiling_Pa`. Lowers the reference as described above.
    [[nodiscard]] float pressure_Pa(const Estimate& estimate, float slip_reference, float ceiling_Pa);
    /// The same for a reference found elsewhere, e.g. by PeakSeeker: lowered only for slip above it, not for the wheel's pole.
    [[nodiscard]] float follow_Pa(const Estimate& estimate, float slip_reference, float ceiling_Pa);

    /// The reference in force.
    [[nodiscard]] float reference() const { return reference_; }
    /// The set-point after its fall at low speed, before the retreat; at least reference(). The law itself does not cause slip above this.
    [[nodiscard]] float scheduled_reference() const { return scheduled_reference_; }

  private:
    void retreat(const Estimate& estimate, float rate_per_s);
    float rate_by_pole_per_s(const Estimate& estimate);
    [[nodiscard]] float earliness(float slip) const;
    float hold_Pa(const Estimate& estimate, float falling, float allowed, float ceiling_Pa);

    SlipConfig config_;
    float period_s_;
    float reference_step_;  // that a period may change the reference by
    float min_share_;
    float early_rate_per_s_;  // by which the largest slip rate is higher without slip
    float reference_ = 0.0F;
    float scheduled_reference_ = 0.0F;
    float integral_ = 0.0F;          // of the slip error times k_i, 1/s
    float share_ = 1.0F;             // of the reference, in force
    float wheel_pole_radps_ = 0.0F;  // filtered
    float slip_error_ = 0.0F;        // distance from the reference, filtered
};

}  // namespace antiskid::control
