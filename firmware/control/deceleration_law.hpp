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

    /// Pressure to ask of the valve, 0 to `ceiling_Pa`; never more than the slip law allows at the slip
    /// limit.
    [[nodiscard]] float pressure_Pa(const Estimate& estimate, float deceleration_mps2, float ceiling_Pa);

  private:
    DecelerationConfig config_;
    SlipLaw guard_;
    float period_s_;
    float measured_mps2_ = 0.0F;
    float reference_mps2_ = 0.0F;
    float integral_Pa_ = 0.0F;
};

}  // namespace antiskid::control
