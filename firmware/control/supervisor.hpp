/// The state machine around the laws: whether braking is permitted now, and which faults are latched.
///
///     self_test -> standby -> armed <-> touchdown_protection
///                    ^          ^               |
///                    |          |               v
///                    |          +------> braking, locked_wheel, drop_out, each to the others
///                    |
///                  safe <-- any state, on any fault
///
/// - standby -> armed: a rising edge of the maneuver command's `arm`; without `arm` every armed state returns to standby
/// - armed: no demand, or no weight on the wheels; a bounce leads back here, with protection at the next touchdown
/// - touchdown_protection: on the wheels, not yet spun up to `spin_up_mps` or to `unlock_share` of the aircraft's speed; at most
///   `touchdown_timeout_s`
/// - braking: the law acts. locked_wheel: rim below `lock_share` of the aircraft's speed until above `unlock_share`; no pressure;
///   not with the open-loop law, nor below `drop_out_mps`. A fault if the released wheel has not spun up after `release_s` plus the time to
///   `unlock_share` at `min_spin_up_mps2`
/// - drop_out: below `drop_out_mps`, until `drop_out_hysteresis_mps` above it; the demand passes through. Only with the laws that
///   need slip
/// - safe: left for standby when the maneuver command disarms, no fault is present and no emergency stop has come for 0.1 s (so that repeated stops
///   count as one); the next arming clears the latched faults
///
/// The valve gets the safe current in every state but braking and drop_out.
#pragma once

#include "firmware/control/config.hpp"
#include "firmware/control/estimate.hpp"
#include "firmware/control/persistence.hpp"
#include "firmware/control/types.hpp"

namespace antiskid::control {

class Supervisor {
  public:
    Supervisor(const SupervisorConfig& config, float period_s);

    /// One period: `present` are the monitor's faults.
    State update(const Sensors& sensors, const Estimate& estimate, FaultSet present, Time now);

    [[nodiscard]] State state() const { return state_; }
    [[nodiscard]] FaultSet latched() const { return latched_; }
    /// On the wheels, with touchdown protection over: an unbraked wheel should roll without slip.
    [[nodiscard]] bool rolling() const { return !protected_; }

  private:
    [[nodiscard]] State next(const Sensors& sensors, const Estimate& estimate, FaultSet present);
    [[nodiscard]] State braking_state(const Sensors& sensors, const Estimate& estimate);
    void watch_touchdown(bool on_wheels, const Estimate& estimate);
    bool stays_locked(bool locked, float speed_mps);

    SupervisorConfig config_;
    float period_s_;
    State state_ = State::self_test;
    FaultSet latched_;
    Persistence self_test_;
    Persistence residual_pressure_;
    Persistence on_wheels_;
    float locked_s_ = 0.0F;
    bool protected_ = true;  // touchdown protection has not ended yet
    bool arm_before_ = true;
    std::uint32_t stop_periods_left_ = 0;
};

}  // namespace antiskid::control
