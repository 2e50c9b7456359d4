/// The classic switching law (Section I): INCREASE, HOLD and DECREASE of pressure, switched by thresholds on
/// slip and wheel deceleration. A baseline for the slip law.
#pragma once

#include "firmware/control/config.hpp"
#include "firmware/control/estimate.hpp"

namespace antiskid::control {

class ThresholdLaw {
  public:
    enum class Action : std::uint8_t { increase, hold, decrease };

    ThresholdLaw(const ThresholdConfig& config, float period_s);

    void start(const Estimate& estimate);
    [[nodiscard]] float pressure_Pa(const Estimate& estimate, float ceiling_Pa);
    [[nodiscard]] Action action() const { return action_; }

  private:
    ThresholdConfig config_;
    float period_s_;
    Action action_ = Action::increase;
    bool skidded_ = false;
    float skid_Pa_ = 0.0F;  // pressure at which the last skid began
    float pressure_ = 0.0F;
};

}  // namespace antiskid::control
