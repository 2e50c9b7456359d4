/// Faults of the valve and its driver, as the current that takes effect.
#pragma once

#include "plant_sim/study/faults/value_fault.hpp"

namespace faults {

/// - valve_current: the value's faults
/// - stuck: the spool stays
/// - slow: it follows with a lag of 20 ms to 1 s by strength
/// - leaking: by 5 to 60 % of the current, off it; if negative, 1 to 15 mA stay on
class ValveFault {
  public:
    ValveFault(const Fault& fault, double period_s);
    [[nodiscard]] double apply(double current_mA, bool active, rig::Random& random);

  private:
    Fault fault_;
    ValueFault value_;
    double period_s_;
    double spool_mA_ = 0.0;
};

}  // namespace faults
