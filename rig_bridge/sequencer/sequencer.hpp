/// The maneuver sequencer: a pure step function like the controller. What is known of the rig goes in with the time,
/// what the rig shall do comes out. No clock, no bus, no Modbus, no allocation in step().
///
///     Sequencer sequencer(plan);
///     for (;;) act(sequencer.step(look(), now_s()));      // until phase() is finished or aborted
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace sequencer {

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

/// Why a maneuver was aborted; the first cause counts.
enum class Abort : std::uint8_t {
    none,
    requested,       ///< the user
    emergency_stop,  ///< interlocks, each by itself
    guard_open,
    hydraulics_lost,
    drive_fault,
    plc_silent,  ///< no fresh registers, or the PLC's watchdog stands still
    plc_tripped,
    command_refused,    ///< the PLC refused a commit, or did not confirm it in time
    controller_silent,  ///< no fresh status frames
    controller_fault,   ///< the controller is in its safe state
    bus_lost,           ///< CAN interface down or bus-off
    sensors_lost,       ///< no fresh encoder or pressure frames
    phase_timeout,      ///< a phase took longer than its limit
    brake_hot,          ///< above the limit for brake-on
    load_lost,          ///< vertical load out of its band while braking
};
inline constexpr std::uint8_t kAbortCount = 16;
[[nodiscard]] std::string_view name(Abort abort);

/// How the current is found; codes as on the bus.
enum class BrakeLaw : std::uint8_t { slip = 0, deceleration = 1, open_loop = 2, threshold = 3 };

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

    // How long and how exactly.
    double speed_tolerance_mps = 0.1;  ///< spin-up is over within this of the set-point ...
    double overspeed_mps = 0.3;  ///< ... which stands this much higher: touchdown and settling cost some
    double settle_s = 1.0;       ///< shortest settling
    double settle_slip = 0.01;   ///< settled when wheel and rim differ by less, for settle_hold_s
    double settle_hold_s = 0.2;
    double standstill_mps = 0.1;
    double hold_s = 0.2;               ///< pressure held after standstill
    double cool_to_C = 1000.0;         ///< end of the cool-down
    double brake_on_limit_C = 1000.0;  ///< no brake-on above it
    double load_band = 0.5;  ///< share of the law by which the measured load may be off while braking

    // Limits of the phases, s.
    double idle_limit_s = 30.0, spin_up_limit_s = 180.0, touchdown_limit_s = 15.0, settling_limit_s = 10.0,
           braking_limit_s = 120.0, retract_limit_s = 30.0, cool_down_limit_s = 3600.0, abort_limit_s = 600.0;
};

/// What is known of the rig. Values count only while the flag of their source is set.
struct Inputs {
    bool plc_fresh = false;  ///< registers younger than the bridge's limit, watchdog alive
    bool plc_ready = false;  ///< PlcState::ready
    bool commit_refused = false;
    bool commit_late = false;  ///< the last command has not been confirmed in time
    bool emergency_stop_clear = false, guard_closed = false, hydraulics_ready = false, drive_healthy = false;
    double flywheel_mps = 0.0;
    double sledge_m = 0.0;
    bool wheel_on_rim = false;
    double load_N = 0.0;
    double brake_temperature_C = 0.0;

    bool bus_up = false;
    bool sensors_fresh = false;  ///< encoder and pressure frames
    double wheel_rim_mps = 0.0;  ///< r omega of the braked wheel, from its encoder
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

class Sequencer {
  public:
    explicit Sequencer(Plan plan);

    /// `now_s` does not fall. Calls may be 1 ms to 100 ms apart.
    [[nodiscard]] Outputs step(const Inputs& inputs, double now_s);

    [[nodiscard]] Phase phase() const { return phase_; }
    [[nodiscard]] Abort abort() const { return abort_; }
    [[nodiscard]] bool over() const { return phase_ == Phase::finished || phase_ == Phase::aborted; }
    [[nodiscard]] const Plan& plan() const { return plan_; }

  private:
    Plan plan_;
    Phase phase_ = Phase::idle;
    Abort abort_ = Abort::none;
};

}  // namespace sequencer
