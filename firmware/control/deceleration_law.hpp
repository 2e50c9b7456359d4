/// The endurance campaign's law (Section IV.B): controls pressure so that the wheel follows a prescribed deceleration.
#pragma once

#include "firmware/control/config.hpp"
#include "firmware/control/slip_law.hpp"

namespace antiskid::control {

class DecelerationLaw {
  public:
    DecelerationLaw(const DecelerationConfig& config, const SlipConfig& slip, float period_s);

    /// Starts from the present pressure, without a step.
    void start(const Estimate& estimate);

    /// Pressure to request, 0 to `ceiling_Pa`. Above half the slip limit it is at most what the slip law requests at that limit.
    [[nodiscard]] float pressure_Pa(const Estimate& estimate, float deceleration_mps2, float ceiling_Pa);

  private:
    [[nodiscard]] float guarded_Pa(const Estimate& estimate, float ceiling_Pa);

    DecelerationConfig config_;
    SlipLaw guard_;
    float period_s_;
    float omega_before_radps_ = 0.0F;
    float behind_radps_ = 0.0F;  // filtered minus unfiltered wheel speed
    float measured_mps2_ = 0.0F;
    float reference_mps2_ = 0.0F;
    float integral_Pa_ = 0.0F;
    float held_Pa_ = 0.0F;  // mean of the last pressures
};

}  // namespace antiskid::control
