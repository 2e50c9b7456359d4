/// The anti-skid controller: one class, one call. Pure: time and measurements are handed in, the valve
/// command is returned.
///
/// Freestanding C++20, single precision, no heap, exceptions, RTTI, I/O, clock or libm; constant work per
/// step.
///
/// Use: construct with a configuration, call `step` once per control period with the newest measurements and
/// the time of the step, send `Command::current_mA` to the valve. The controller never blocks and never
/// fails: whatever is wrong with its inputs ends in `State::safe` with a named fault and the safe current.
///
///     Sensors -> Estimator -> Estimate -> law -> pressure, at most the demand -> inverse valve map ->
///     Command
///        |                       |         ^
///        +-----> Monitor <-------+         |
///                   |                      |
///                   +--> Supervisor: state, permission
#pragma once

#include "firmware/control/config.hpp"
#include "firmware/control/deceleration_law.hpp"
#include "firmware/control/estimator.hpp"
#include "firmware/control/monitor.hpp"
#include "firmware/control/peak_seeker.hpp"
#include "firmware/control/pressure_bias_law.hpp"
#include "firmware/control/slip_law.hpp"
#include "firmware/control/supervisor.hpp"
#include "firmware/control/threshold_law.hpp"
#include "firmware/control/types.hpp"

namespace antiskid::control {

class Controller {
  public:
    /// `config` must have passed the checks of its loader; period 1 to 5 ms.
    explicit Controller(const Config& config);

    /// One control period. `now` must grow by about Config::period_s from call to call; ages of inputs are
    /// taken against it.
    [[nodiscard]] Command step(const Sensors& sensors, Time now);

    /// What the controller believes after the last step, for recording.
    [[nodiscard]] const Estimate& estimate() const { return estimator_.estimate(); }

  private:
    [[nodiscard]] float braking_pressure_Pa(const ManeuverInput& maneuver, const Estimate& estimate, State before);
    [[nodiscard]] float pass_through_Pa(float ceiling_Pa, const Estimate& estimate, State before);
    [[nodiscard]] float asked_of_map_Pa(const Command& command, Law law) const;
    void start_law(Law law, const Estimate& estimate, State before);

    ValveConfig valve_;
    float pass_through_step_Pa_;  // the most by which a demand that passes through may rise in a period
    Estimator estimator_;
    Monitor monitor_;
    Supervisor supervisor_;
    SlipLaw slip_law_;
    PeakSeeker peak_seeker_;
    DecelerationLaw deceleration_law_;
    ThresholdLaw threshold_law_;
    PressureBiasLaw pressure_bias_law_;
    Law law_ = Law::wheel_slip;
    float passed_Pa_ = 0.0F;
    float requested_Pa_ = 0.0F;  // by the last step
    float takeover_Pa_;          // ceiling while one law takes over from another
    // Static pressures by the map, of the current that is safe, of the last step's, and of what the valve holds: the last that left.
    float safe_Pa_, commanded_Pa_, held_Pa_;
};

}  // namespace antiskid::control
