/// Faults of the valve and its driver, applied to the effective current.
#pragma once

#include "plant_sim/study/faults/value_fault.hpp"

namespace faults {

/// - valve_current: the faults of a value
/// - stuck: the spool does not move
/// - slow: the current follows with a lag of 20 ms to 1 s, by strength
/// - leaking: 5 to 60 % of the current are lost; if negative, the current is at least 1 to 15 mA
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
