/// Inputs and outputs of the controller: SI values with their time of reception. Independent of bus, clock and operating system.
///
/// Units are SI base units unless a name says otherwise (`_Pa`, `_mA`, `_radps`, `_mps`, `_mps2`).
/// Slip is dimensionless, eq. (3): 0 free rolling, 1 locked.
#pragma once

#include <chrono>
#include <cstdint>

namespace antiskid::control {

/// Monotonic time of the controller's own clock; its zero is arbitrary. Always passed in: the controller reads no clock.
using Time = std::chrono::duration<std::int64_t, std::nano>;

/// `received` of an input that has never arrived.
inline constexpr Time kNever{INT64_MIN};

/// How a speed sensor reports.
enum class SpeedSource : std::uint8_t {
    edges,  ///< toothed encoder: edge count and time of the last edge, speed by the M/T method
    speed,  ///< the sensor reports angular speed itself
};

/// One rotational speed sensor.
struct SpeedInput {
    Time received = kNever;      ///< when the newest accepted frame arrived
    std::uint32_t rejected = 0;  ///< frames refused since start (check value, alive counter, length); rolls over
    SpeedSource source = SpeedSource::edges;
    std::uint32_t edge_count = 0;  ///< edges since an arbitrary start; rolls over at 2^32; only differences count
    Time edge_time{};              ///< time of the last counted edge in the sensor's own clock; only differences count
    float speed_radps = 0.0F;      ///< used when source is `speed`
};

struct PressureInput {
    Time received = kNever;
    std::uint32_t rejected = 0;
    float pressure_Pa = 0.0F;
};

/// How the valve current is determined while braking.
enum class Law : std::uint8_t {
    wheel_slip = 0,     ///< PID on slip, Section V
    deceleration = 1,   ///< prescribed wheel deceleration, the endurance campaign's law, Section IV.B
    open_loop = 2,      ///< the commanded current, limited by the demand
    threshold = 3,      ///< HOLD, DECREASE, INCREASE on wheel deceleration and slip, Section I: a baseline
    pressure_bias = 4,  ///< velocity error, its integral as a bias, lead: a baseline, as in fielded systems
    peak_slip = 5,      ///< PID on slip, at the slip of maximum friction, which it finds itself
};
inline constexpr std::uint8_t kLawCount = 6;

[[nodiscard]] constexpr bool holds_slip(Law law) {
    return law == Law::wheel_slip || law == Law::peak_slip;
}

/// Commands of the pilot or of the rig's sequencer.
struct ManeuverInput {
    Time received = kNever;
    std::uint32_t rejected = 0;
    Law law = Law::wheel_slip;
    bool arm = false;                ///< false to true permits braking (and clears latched faults); false withdraws the permission
    bool weight_on_wheels = false;   ///< squat switch, or the sledge holding the wheel on the flywheel
    float demand_Pa = 0.0F;          ///< the pilot's demand: upper limit of brake pressure under every law
    float slip_reference = 0.0F;     ///< lambda bar of `wheel_slip`, 0 to 0.5
    float deceleration_mps2 = 0.0F;  ///< wheel deceleration reference, as rim deceleration
    float current_mA = 0.0F;         ///< open loop valve current
};

/// All inputs of the controller at a step. Each member keeps its last accepted value until a newer one arrives.
struct Sensors {
    SpeedInput wheel;
    SpeedInput flywheel;  ///< its rim speed is the aircraft's speed
    PressureInput pressure;
    ManeuverInput maneuver;
    Time rig_heartbeat_received = kNever;
    bool emergency_stop = false;       ///< an emergency stop frame was accepted since the last step
    bool bus_off = false;              ///< the interface is bus-off or down
    std::uint32_t missed_periods = 0;  ///< periods without a step since the last step
    bool command_unsent = false;       ///< the last step's command was not sent: the valve holds the previous one
};

enum class State : std::uint8_t {
    self_test = 0,
    standby = 1,
    armed = 2,
    touchdown_protection = 3,
    braking = 4,
    locked_wheel = 5,
    drop_out = 6,
    safe = 7,  ///< valve at the safe current; left only by disarming, with every cause gone
};
inline constexpr std::uint8_t kStateCount = 8;

/// Named faults. The number is the bit in the status frame; docs/user/faults.md has condition, reaction and time
/// of each.
enum class Fault : std::uint8_t {
    wheel_lost = 0,
    wheel_corrupt = 1,
    wheel_range = 2,
    wheel_rate = 3,
    wheel_stuck = 4,
    flywheel_lost = 5,
    flywheel_corrupt = 6,
    flywheel_range = 7,
    flywheel_rate = 8,
    flywheel_stuck = 9,
    pressure_lost = 10,
    pressure_corrupt = 11,
    pressure_range = 12,
    pressure_rate = 13,
    pressure_stuck = 14,
    speeds_disagree = 15,
    pressure_off_command = 16,
    maneuver_lost = 17,
    maneuver_corrupt = 18,
    maneuver_range = 19,
    heartbeat_lost = 20,
    emergency_stop = 21,
    bus_off = 22,
    overrun = 23,
    lock_persists = 24,
    self_test_failed = 25,
};
inline constexpr std::uint8_t kFaultCount = 26;

/// A set of faults, one bit each.
class FaultSet {
  public:
    constexpr void insert(Fault fault) { bits_ |= bit(fault); }
    constexpr void insert(FaultSet other) { bits_ |= other.bits_; }
    [[nodiscard]] constexpr bool contains(Fault fault) const { return (bits_ & bit(fault)) != 0; }
    [[nodiscard]] constexpr bool empty() const { return bits_ == 0; }
    [[nodiscard]] constexpr std::uint32_t bits() const { return bits_; }
    constexpr bool operator==(const FaultSet&) const = default;

    [[nodiscard]] static constexpr FaultSet from_bits(std::uint32_t bits) {
        FaultSet set;
        set.bits_ = bits & ((1U << kFaultCount) - 1U);
        return set;
    }

  private:
    [[nodiscard]] static constexpr std::uint32_t bit(Fault fault) { return 1U << static_cast<std::uint8_t>(fault); }
    std::uint32_t bits_ = 0;
};

/// Result of the search for the slip of maximum friction; all zero under any other law and while not braking.
struct RoadEstimate {
    float peak_slip = 0.0F;   ///< slip of maximum friction, without the test signal on the reference
    float grip_N = 0.0F;      ///< friction force F_x there, only as accurate as WheelConfig::brake_gain_m3
    float confidence = 0.0F;  ///< 0: nothing known; 1: slip at the peak, with known slope
};

/// Result of one step.
struct Command {
    float current_mA = 0.0F;  ///< valve current to apply until the next command
    State state = State::self_test;
    FaultSet faults;              ///< latched faults
    float slip = 0.0F;            ///< measured slip, eq. (3); 0 if unknown
    float slip_reference = 0.0F;  ///< the reference in force after scheduling and rate limit
    float speed_mps = 0.0F;       ///< measured aircraft (flywheel rim) speed
    float wheel_speed_radps = 0.0F;
    float pressure_request_Pa = 0.0F;  ///< pressure requested by the law, never above the demand
    RoadEstimate road;
};

}  // namespace antiskid::control
