/// The maneuver sequencer: a pure step function like the controller. Inputs are the rig's state and the time, outputs the commands to the rig. No
/// clock, no bus, no Modbus, no allocation in step().
///
///     Sequencer sequencer(plan);
///     while (!sequencer.over()) act(sequencer.step(inputs(), now_s()));
///
///     idle -> spin_up -> touchdown -> settling -> braking -> standstill -> retract -> cool_down -> finished
///       any of them -> aborting -> aborted
///
/// What is on in each phase (everything else is off, demand 0), and the condition that ends it:
///   idle        nothing on. Every interlock good, PLC ready, sledge back, flywheel not above the set-point, brake cold enough for
///               brake-on, no pressure, controller in standby
///   spin_up     drive on. Set-point (below) held within `speed_tolerance_mps`: arms; controller armed: next phase
///   touchdown   armed, sledge advances, load enabled, drive off. Wheel on the rim: next phase
///   settling    the same, weight on wheels. `settle_s` over, slip below `settle_slip` and load within its band for
///               `settle_hold_s`, and the speed has fallen to the prescribed one: brake-on
///   braking     the same, full demand. Standstill: next phase
///   standstill  demand for `hold_s`, then none; pressure gone: next phase
///   retract     disarmed, load off, sledge back. Sledge back: next phase
///   cool_down   nothing on. Brake at `cool_to_C`: finished
/// Each phase has a time limit. A step advances by at most one phase; the first is always idle.
///
/// The drive's set-point v' is chosen so that the prescribed speed v remains after touchdown, when the flywheel accelerates the wheel, which turns at
/// omega, to its rim speed: m v' + (J_w / r^2) r omega = (m + J_w / r^2) v. omega is measured, so that speed at brake-on is the same if the wheel
/// still turns after an abort. `coasting_mps` is added for drag. As the wheel slows down, the set-point rises in steps of half the tolerance.
///
/// Abort: its conditions are checked first in every phase; the outputs of the same step are already safe: disarmed, no demand, no current, drive off,
/// load off, sledge back. In idle, where nothing is on, a condition only prevents the start; it becomes the abort cause when idle times out. Causes
/// for which stops_controller() is true also send the emergency stop during aborting. NaN counts as missing: its source is treated as silent.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace rig {

/// Phases of one maneuver, Section II of the paper. The number is the code on the bus.
enum class Phase : std::uint8_t {
    idle = 0,        ///< before start: waits until rig and controller are ready
    spin_up = 1,     ///< the drive brings the flywheel to the prescribed speed, wheel off the rim
    touchdown = 2,   ///< drive off, sledge to the rim with the prescribed load
    settling = 3,    ///< until the wheel's speed has settled
    braking = 4,     ///< brake-on to standstill, dynamic load
    standstill = 5,  ///< pressure held, then released
    retract = 6,     ///< sledge back
    cool_down = 7,   ///< until the brake is cold enough for the next
    finished = 8,
    aborting = 9,  ///< valve safe, drive off, sledge back, flywheel coasting
    aborted = 10,  ///< safe end reached (or, after a time-out, given up waiting for it)
};
inline constexpr std::uint8_t kPhaseCount = 11;
[[nodiscard]] std::string_view name(Phase phase);

/// Why a maneuver was aborted: the first cause, except that two_senders replaces controller_silent or controller_fault if found later. Of several in
/// one step the first in this order, nearest to the root, is taken: plc_silent, interlocks, plc_tripped, foreign_command, command_rejected,
/// overspeed, bus_lost, bus_unread, two_senders, controller_silent, sensors_lost, speed_mismatch, controller_fault, load_lost, brake_hot, requested,
/// phase_timeout. What each means, in plain words, and what to do: next_step.hpp.
enum class Abort : std::uint8_t {
    none,
    requested,       ///< the user
    emergency_stop,  ///< interlocks, each by itself
    guard_open,
    hydraulics_lost,
    drive_fault,
    plc_silent,  ///< no fresh registers, a register that is no number, or the PLC's watchdog stands still
    plc_tripped,
    command_rejected,   ///< the PLC refused a commit or did not confirm it in time; or the sledge is out while the drive is on
    controller_silent,  ///< no fresh status frames
    controller_fault,   ///< the controller is in its safe state; or, from touchdown to the end of the hold, not armed
    bus_lost,           ///< CAN interface down or bus-off
    sensors_lost,       ///< no fresh encoder or pressure frames, or a reading that is no number
    phase_timeout,      ///< a phase took longer than its limit
    brake_hot,          ///< above the limit for brake-on, before brake-on
    load_lost,          ///< while braking: vertical load out of its band, or the wheel off the rim
    foreign_command,    ///< the PLC took over, or refused, a command that is not ours
    overspeed,          ///< the flywheel is faster than top_speed_mps(), by the PLC's reading
    speed_mismatch,     ///< PLC and encoder on the bus differ in the rim's speed for `mismatch_s`
    two_senders,        ///< two controllers, or two bridges, send on the bus
    bus_unread,         ///< the bridge itself did not read the bus in time; nothing is known of interface, controller and sensors
};
inline constexpr std::uint8_t kAbortCount = 21;
[[nodiscard]] std::string_view name(Abort abort);

/// Causes that send the emergency stop, because disarming by the maneuver command may not suffice: danger to people or machine, a wheel that may
/// leave the rim under pressure, or a controller that may not receive commands. The others (requested, command_rejected, controller_fault,
/// phase_timeout, brake_hot) only disarm, which is as fast and leaves the controller in standby without latched faults.
[[nodiscard]] bool stops_controller(Abort abort);

/// How the valve current is determined; codes as on the bus.
enum class BrakeLaw : std::uint8_t { slip = 0, deceleration = 1, open_loop = 2, threshold = 3, pressure_bias = 4, peak_slip = 5 };

struct CurrentPoint {
    double time_s = 0.0;  ///< since brake-on
    double current_mA = 0.0;
};

/// One maneuver, every number set: a scenario file (load_scenario.hpp) after its random draws.
struct Plan {
    double speed_mps = 0.0;    ///< prescribed rim speed at brake-on
    double load_base_N = 0.0;  ///< eq. (2): F_z = load_base_N - load_lift_Ns2pm2 v^2
    double load_lift_Ns2pm2 = 0.0;
    BrakeLaw law = BrakeLaw::slip;
    double demand_Pa = 0.0;
    double slip_reference = 0.0;
    double deceleration_mps2 = 0.0;
    std::vector<CurrentPoint> current;  ///< of the open-loop law

    // Durations and tolerances.
    double speed_tolerance_mps = 0.02;  ///< spin-up ends within this of the set-point; largest excess of speed at brake-on
    double wheel_share = 0.005;         ///< J_w / (m r^2): inertia of the wheel, at the rim, over the flywheel's
    double rolling_radius_m = 0.32;     ///< r(F_z) of the wheel at brake-on
    double coasting_mps = 0.07;         ///< lost to drag between drive off and brake-on
    double settle_s = 1.0;              ///< shortest settling
    double settle_slip = 0.01;          ///< settled when wheel and rim differ by less, for settle_hold_s
    double settle_hold_s = 0.2;
    /// Allowed shortfall of speed at brake-on, excess of rim speed over the largest set-point, and difference between PLC and encoder.
    double speed_band_mps = 2.0;
    double encoder_blind_mps = 0.0;  ///< below this rim speed the flywheel's encoder may show none: its pick-up needs a rate of edges
    double mismatch_s = 0.5;         ///< how long PLC and encoder may differ by more, because readings are delayed by the link
    double standstill_mps = 0.1;
    double sledge_back_m = 0.01;       ///< retracted is below this
    double pressure_gone_Pa = 0.5e6;   ///< released is below this
    double hold_s = 0.2;               ///< pressure held after standstill
    double cool_to_C = 1000.0;         ///< end of the cool-down
    double brake_on_limit_C = 1000.0;  ///< no brake-on above it
    double load_band = 0.5;            ///< allowed relative deviation of the measured load from the law while braking

    // Limits of the phases, s.
    double idle_limit_s = 30.0, spin_up_limit_s = 180.0, touchdown_limit_s = 15.0, settling_limit_s = 10.0, braking_limit_s = 120.0,
           standstill_limit_s = 10.0, retract_limit_s = 30.0, cool_down_limit_s = 3600.0, abort_limit_s = 600.0;
};

/// The rig's state. Values are valid only while their source's flag is set.
struct Inputs {
    bool plc_fresh = false;  ///< registers younger than the bridge's limit, watchdog alive
    bool plc_ready = false;  ///< PlcState::ready
    bool commit_rejected = false;
    bool commit_late = false;      ///< the last command has not been confirmed in time
    bool foreign_command = false;  ///< the PLC has answered another client's command since the last step
    bool emergency_stop_clear = false, guard_closed = false, hydraulics_ready = false, drive_healthy = false;
    double flywheel_mps = 0.0;
    double flywheel_age_s = 0.0;  ///< of that reading
    double sledge_m = 0.0;
    bool wheel_on_rim = false;
    double load_N = 0.0;
    double brake_temperature_C = 0.0;

    bool bus_up = false;         ///< CAN interface up and not bus-off
    bool bus_read = false;       ///< by the recorder, in time; if not, nothing below is known
    bool two_senders = false;    ///< two controllers, or two bridges, send
    bool sensors_fresh = false;  ///< encoder and pressure frames
    double rim_mps = 0.0;        ///< of the flywheel, from the encoder on the bus
    double rim_age_s = 0.0;      ///< of its newest frame
    double wheel_radps = 0.0;    ///< omega of the braked wheel, from its encoder
    double wheel_rim_mps = 0.0;  ///< r omega of it, r under the present load
    double pressure_Pa = 0.0;    ///< brake pressure, measured
    bool controller_fresh = false;
    bool controller_standby = false;  ///< self-test passed, not armed
    bool controller_armed = false;    ///< any state with permission
    bool controller_safe = false;     ///< its safe state

    bool abort_requested = false;
};

struct Outputs {
    Phase phase = Phase::idle;
    Abort abort = Abort::none;
    // to the PLC
    bool drive_enable = false;
    double flywheel_set_mps = 0.0;
    bool sledge_advance = false;
    bool load_enable = false;
    double load_base_N = 0.0;
    double load_lift_Ns2pm2 = 0.0;
    // to the controller
    bool arm = false;
    bool weight_on_wheels = false;
    BrakeLaw law = BrakeLaw::slip;
    double demand_Pa = 0.0;
    double slip_reference = 0.0;
    double deceleration_mps2 = 0.0;
    double current_mA = 0.0;
    bool emergency_stop = false;  ///< send the emergency stop frame
};

/// Highest allowed rim speed: the set-point for a wheel at standstill plus `speed_band_mps`.
[[nodiscard]] double top_speed_mps(const Plan& plan);

class Sequencer {
  public:
    /// Throws std::invalid_argument, naming the member, for a plan that cannot be run: a number that is not finite or negative where it may
    /// not be, a load law that falls to zero at the prescribed speed, an open loop without a rising profile.
    explicit Sequencer(Plan plan);

    /// `now_s` must not decrease (if it does, time stops). Calls are 1 ms to 100 ms apart; the first one starts the clock.
    [[nodiscard]] Outputs step(const Inputs& inputs, double now_s);

    [[nodiscard]] Phase phase() const { return phase_; }
    [[nodiscard]] Abort abort() const { return abort_; }
    [[nodiscard]] bool over() const { return phase_ == Phase::finished || phase_ == Phase::aborted; }
    /// Whether, after an abort, the safe end was reached: sledge back, no pressure. False if it was not within `abort_limit_s`.
    [[nodiscard]] bool safe_end_seen() const { return phase_ == Phase::aborted && safe_end_; }
    [[nodiscard]] const Plan& plan() const { return plan_; }

  private:
    [[nodiscard]] Abort cause(const Inputs& inputs) const;
    [[nodiscard]] bool done(const Inputs& inputs);
    [[nodiscard]] bool ready(const Inputs& inputs) const;
    void compare_speeds(const Inputs& inputs, double passed_s);
    [[nodiscard]] double set_point_mps(const Inputs& inputs) const;
    [[nodiscard]] bool at_speed(const Inputs& inputs);
    [[nodiscard]] bool settled(const Inputs& inputs);
    [[nodiscard]] bool released(const Inputs& inputs);
    [[nodiscard]] bool sledge_back(const Inputs& inputs) const;
    [[nodiscard]] bool load_in_band(const Inputs& inputs) const;
    [[nodiscard]] double limit_s() const;
    [[nodiscard]] double elapsed_s() const { return now_s_ - entered_s_; }
    void enter(Phase phase);
    void leave_for_abort(Abort cause);
    [[nodiscard]] Outputs outputs(const Inputs& inputs) const;
    void brake(Outputs& out) const;
    [[nodiscard]] double current_mA(double since_brake_on_s) const;

    Plan plan_;
    Phase phase_ = Phase::idle;
    Abort abort_ = Abort::none;
    bool started_ = false;
    double now_s_ = 0.0;
    double entered_s_ = 0.0;  // the phase
    double brake_on_s_ = 0.0;
    double unsettled_s_ = 0.0;  // newest time at which the wheel was not settled
    double disagreed_s_ = 0.0;  // for which PLC and encoder, both fresh, have differed in speed
    double set_mps_ = 0.0;      // in spin_up: set-point of the drive
    bool arming_ = false;       // in spin_up: the set-point was reached
    bool safe_end_ = false;
};

}  // namespace rig
