/// Finds the slip of maximum friction while braking on an unknown runway.
///
/// Controls the elasticity of friction over slip, (lambda / mu) d mu / d lambda, to a target: 0 at the peak, positive below it. With the observer's
/// pole a and road torque tau (wheel_observer.hpp) it is a lambda v / (r tau): load, inertia and brake gain cancel. The reference changes in
/// proportion to the difference from the target, with a small periodic test signal, because the slope cannot be estimated at constant slip (extremum
/// seeking: K. B. Ariyur and M. Krstic, Real-Time Optimization by Extremum-Seeking Control, Wiley 2003).
#pragma once

#include "firmware/control/arithmetic.hpp"
#include "firmware/control/config.hpp"
#include "firmware/control/estimate.hpp"
#include "firmware/control/types.hpp"

namespace antiskid::control {

class PeakSeeker {
  public:
    PeakSeeker(const PeakConfig& config, float inertia_kgm2, float period_s);

    /// Restarts after a lock or another law: keeps the slip found, discards the measured elasticity. After a lock, where slip was far beyond the
    /// peak, the search restarts at `start_slip` if the reference was larger.
    void start(bool locked) {
        elasticity_ = 0.0F;
        if (locked) slip_ = smaller(slip_, config_.start_slip);
    }
    /// Resets the search for another landing.
    void forget_runway() {
        slip_ = config_.start_slip;
        grip_N_ = 0.0F;
        confidence_ = 0.0F;
    }

    /// Slip reference for this period. Call once a period.
    [[nodiscard]] float reference(const Estimate& estimate);

    /// The result. The grip is the friction force, averaged with a weight that is largest at the peak.
    [[nodiscard]] RoadEstimate found() const { return {slip_, grip_N_, confidence_}; }
    /// Measured elasticity at the present slip, filtered.
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
    float phase_ = 0.0F;  // of the test signal, in turns
};

}  // namespace antiskid::control
