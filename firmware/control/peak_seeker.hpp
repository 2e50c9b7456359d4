/// The slip of most friction, found while braking, without being told the runway.
///
/// What is sought is where the elasticity of friction over slip, (lambda / mu) d mu / d lambda, is as asked for: 0 at the peak, positive
/// before it. With the observer's answer a and road torque tau (wheel_observer.hpp) it is a lambda v / (r tau): load, inertia and brake gain
/// cancel. The reference grows or falls in proportion to what is missing, and swings a little, since a wheel that keeps its slip learns
/// nothing of the slope (extremum seeking: K. B. Ariyur and M. Krstic, Real-Time Optimization by Extremum-Seeking Control, Wiley 2003).
#pragma once

#include "firmware/control/arithmetic.hpp"
#include "firmware/control/config.hpp"
#include "firmware/control/estimate.hpp"
#include "firmware/control/types.hpp"

namespace antiskid::control {

class PeakSeeker {
  public:
    PeakSeeker(const PeakConfig& config, float inertia_kgm2, float period_s);

    /// The wheel comes back from a lock or another law: what was found stays, what was measured goes. After a lock, which is slip far past the
    /// peak, it is sought from `start_slip` again if more was in force.
    void start(bool locked) {
        elasticity_ = 0.0F;
        if (locked) slip_ = smaller(slip_, config_.start_slip);
    }
    /// On another landing it begins anew.
    void forget_runway() {
        slip_ = config_.start_slip;
        grip_N_ = 0.0F;
        confidence_ = 0.0F;
    }

    /// Slip reference to hold now. Once a period.
    [[nodiscard]] float reference(const Estimate& estimate);

    /// What was found. The grip is the friction force, taken in as far as the slip is at the peak, where friction does not change with slip.
    [[nodiscard]] RoadEstimate found() const { return {slip_, grip_N_, confidence_}; }
    /// Measured at the present slip, filtered.
    [[nodiscard]] float elasticity() const { return elasticity_; }

  private:
    void follow(const Estimate& estimate);

    PeakConfig config_;
    float inertia_kgm2_;
    float period_s_;
    float slip_;
    float elasticity_ = 0.0F;
    float grip_N_ = 0.0F;
    float confidence_ = 0.0F;
    float phase_ = 0.0F;  // of the swing, in turns
};

}  // namespace antiskid::control
