/// The state machine around the laws: who may brake now, and what faults are latched.
///
///     self_test -> standby -> armed -> touchdown_protection -> braking <-> locked_wheel
///                    ^          ^              ^                  |
///                    |          +---- demand released ------------+-> drop_out
///                    +-- safe <-- any state, on any fault
///
/// `safe` is left for `standby` when the maneuver command disarms and no cause is left; arming again clears
/// the latched names.
#pragma once

#include "firmware/control/config.hpp"
#include "firmware/control/estimate.hpp"
#include "firmware/control/monitor.hpp"
#include "firmware/control/types.hpp"

namespace antiskid::control {

class Supervisor {
  public:
    Supervisor(const SupervisorConfig& config, float period_s);

    /// One period: `present` are the monitor's faults.
    State update(const Sensors& sensors, const Estimate& estimate, FaultSet present, Time now);

    [[nodiscard]] State state() const { return state_; }
    [[nodiscard]] FaultSet latched() const { return latched_; }
    /// On the wheels and spun up since touchdown: a free wheel should roll without slip.
    [[nodiscard]] bool rolling() const { return spun_up_; }

  private:
    [[nodiscard]] State next(const Sensors& sensors, const Estimate& estimate, FaultSet present);
    [[nodiscard]] State braking_state(const Sensors& sensors, const Estimate& estimate);
    void watch_touchdown(bool on_wheels, const Estimate& estimate);

    SupervisorConfig config_;
    float period_s_;
    State state_ = State::self_test;
    FaultSet latched_;
    Persistence self_test_;
    Persistence residual_pressure_;
    Persistence on_wheels_;
    Persistence locked_;
    bool spun_up_ = false;
    bool protected_ = true;  // touchdown protection has not ended yet
    bool arm_before_ = true;
};

}  // namespace antiskid::control
