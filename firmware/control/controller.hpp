/// The anti-skid controller. Pure: time and measurements are arguments, the valve command is the result.
///
/// Freestanding C++20, single precision, no heap, exceptions, RTTI, I/O, clock or libm; constant work per
/// step.
///
/// Use: construct with a configuration, call `step` once per control period with the newest measurements and
/// the time of the step, send `Command::current_mA` to the valve. The controller never blocks or fails: a persistent error of its inputs leads to
/// `State::safe` with a named fault and the safe current.
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

    /// One control period. `now` must increase by about Config::period_s from call to call; ages of inputs are relative to it.
    [[nodiscard]] Command step(const Sensors& sensors, Time now);

    /// The estimate after the last step, for recording.
    [[nodiscard]] const Estimate& estimate() const { return estimator_.estimate(); }

  private:
    [[nodiscard]] float braking_pressure_Pa(const ManeuverInput& maneuver, const Estimate& estimate, State before);
    [[nodiscard]] float pass_through_Pa(float ceiling_Pa, const Estimate& estimate, State before);
    [[nodiscard]] float asked_of_map_Pa(const Command& command, Law law) const;
    void start_law(Law law, const Estimate& estimate, State before);

    ValveConfig valve_;
    float pass_through_step_Pa_;  // largest rise per period of a demand that passes through
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
    // Static pressures by the map: at the safe current, at the last step's current, and at the last current that was sent.
    float safe_Pa_, commanded_Pa_, held_Pa_;
};

}  // namespace antiskid::control
