/// The slip law that goes with WheelObserver: PID on slip predicted with the road's answer, its gain as large as the answer allows, and a
/// reference that retreats towards the peak of friction when the wheel runs away faster than the valve can follow.
#pragma once

#include "firmware/control/config.hpp"
#include "firmware/control/estimate.hpp"

namespace antiskid::control {

class ObservedSlipLaw {
  public:
    ObservedSlipLaw(const ObserverConfig& config, const SlipConfig& slip, float period_s);

    /// Starts from rest at the present slip. What it has learnt of the reference stays.
    void start(const Estimate& estimate);

    /// Pressure to ask of the valve, 0 to `ceiling_Pa`.
    [[nodiscard]] float pressure_Pa(const Estimate& estimate, float slip_reference, float ceiling_Pa);

    /// The reference in force.
    [[nodiscard]] float reference() const { return reference_; }
    /// What it was before it retreated, if it did: slip above this is not what the law does.
    [[nodiscard]] float asked() const { return asked_; }

  private:
    void follow_answer(const Estimate& estimate);

    ObserverConfig config_;
    SlipConfig slip_;
    float period_s_;
    float reference_ = 0.0F;
    float asked_ = 0.0F;
    float integral_ = 0.0F;      // of the slip error times k_i, 1/s
    float share_ = 1.0F;         // of the reference that may be in force
    float answer_per_s_ = 0.0F;  // filtered
};

}  // namespace antiskid::control
