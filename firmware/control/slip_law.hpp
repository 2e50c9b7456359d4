/// The wheel-slip law of Section V: PID on slip, predicted over the valve's delay, on top of the pressure that balances the road. Its gain
/// grows with the road's answer to slip, and its reference retreats towards the peak of friction when the wheel runs away faster than the
/// valve can follow, and where the slip stays above it.
#pragma once

#include "firmware/control/arithmetic.hpp"
#include "firmware/control/config.hpp"
#include "firmware/control/estimate.hpp"

namespace antiskid::control {

/// `slip_reference`, below SlipConfig::low_speed_mps less.
[[nodiscard]] constexpr float falling_reference(const SlipConfig& config, float slip_reference, float speed_mps) {
    if (speed_mps >= config.low_speed_mps) return slip_reference;
    const float low = smaller(slip_reference, config.low_speed_slip);
    const float share = limited((speed_mps - config.low_speed_floor_mps) / (config.low_speed_mps - config.low_speed_floor_mps), 0.0F, 1.0F);
    return low + share * (slip_reference - low);
}

/// No larger reference is accepted.
inline constexpr float kMaxSlipReference = 0.5F;

/// A sound loop holds the slip within this of its reference.
inline constexpr float kHeldWithin = 0.05F;

class SlipLaw {
  public:
    SlipLaw(const SlipConfig& config, float period_s);

    /// Starts from rest at the present slip. What it has learnt of the reference stays.
    void start(const Estimate& estimate);
    /// On another landing the whole reference may be in force again.
    void forget_runway() { share_ = 1.0F; }

    /// Pressure to ask of the valve, 0 to `ceiling_Pa`. The reference retreats.
    [[nodiscard]] float pressure_Pa(const Estimate& estimate, float slip_reference, float ceiling_Pa);
    /// The same for a reference that somebody else has found: it retreats from slip above it alone, whatever the road answers.
    [[nodiscard]] float follow_Pa(const Estimate& estimate, float slip_reference, float ceiling_Pa);

    /// The reference in force.
    [[nodiscard]] float reference() const { return reference_; }
    /// What it was before it retreated, if it did: slip above this is not what the law does.
    [[nodiscard]] float asked() const { return asked_; }

  private:
    void retreat(const Estimate& estimate, float rate_per_s);
    float answered_rate_per_s(const Estimate& estimate);
    [[nodiscard]] float earliness(float slip) const;
    float hold_Pa(const Estimate& estimate, float falling, float allowed, float ceiling_Pa);

    SlipConfig config_;
    float period_s_;
    float reference_ = 0.0F;
    float asked_ = 0.0F;
    float integral_ = 0.0F;      // of the slip error times k_i, 1/s
    float share_ = 1.0F;         // of the reference that may be in force
    float answer_per_s_ = 0.0F;  // filtered
    float off_slip_ = 0.0F;      // distance from the reference, filtered
};

}  // namespace antiskid::control
