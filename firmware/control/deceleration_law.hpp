/// The endurance campaign's law (Section IV.B): pressure that makes the wheel follow a prescribed
/// deceleration.
#pragma once

#include "firmware/control/config.hpp"
#include "firmware/control/slip_law.hpp"

namespace antiskid::control {

class DecelerationLaw {
  public:
    DecelerationLaw(const DecelerationConfig& config, const SlipConfig& slip, float period_s);

    /// Takes over from the present pressure.
    void start(const Estimate& estimate);

    /// Pressure to ask of the valve, 0 to `ceiling_Pa`. Above half the slip limit never more than the slip law asks
    /// for at the limit.
    [[nodiscard]] float pressure_Pa(const Estimate& estimate, float deceleration_mps2, float ceiling_Pa);

  private:
    [[nodiscard]] float guarded_Pa(const Estimate& estimate, float ceiling_Pa);

    DecelerationConfig config_;
    SlipLaw guard_;
    float period_s_;
    float omega_before_radps_ = 0.0F;
    float behind_radps_ = 0.0F;  // filtered wheel speed less wheel speed
    float measured_mps2_ = 0.0F;
    float reference_mps2_ = 0.0F;
    float integral_Pa_ = 0.0F;
    float held_Pa_ = 0.0F;  // mean of the last pressures
};

}  // namespace antiskid::control
