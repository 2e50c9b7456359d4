/// The anti-skid controller: one class, one call. Pure: time and measurements are handed in, the valve command is returned.
///
/// Freestanding C++20, single precision, no heap, exceptions, RTTI, I/O, clock or libm; constant work per step.
///
/// Use: construct with a configuration, call `step` once per control period with the newest measurements and the time of the step,
/// send `Command::current_mA` to the valve. The controller never blocks and never fails: whatever is wrong with its inputs ends in
/// `State::safe` with a named fault and the safe current.
#pragma once

#include "firmware/control/config.hpp"
#include "firmware/control/types.hpp"

namespace antiskid::control {

class Controller {
  public:
    explicit Controller(const Config& config);

    /// One control period. `now` must grow by about Config::period_s from call to call; ages of inputs are taken against it.
    [[nodiscard]] Command step(const Sensors& sensors, Time now);
};

}  // namespace antiskid::control
