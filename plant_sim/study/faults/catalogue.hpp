/// Catalogue of faults: each signal with the kinds of fault that it can have, and the severity of one fault.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "rig_bridge/rig/random.hpp"

namespace faults {

/// Where the fault occurs.
enum class Signal : std::uint8_t {
    wheel,     ///< encoder and its frame
    flywheel,  ///< encoder and its frame
    pressure,  ///< transducer and its frame
    maneuver,  ///< the frame; the next five are values in it
    demand,    ///< as sent by the rig's sequencer, as the next four
    slip_reference,
    arm,
    weight_on_wheels,
    law,
    heartbeat,       ///< the rig's
    emergency_stop,  ///< pressed when the fault begins
    valve_command,   ///< the frame
    valve_current,   ///< as output by the valve's driver
    valve,           ///< its hydraulics
    controller,      ///< its loop, its interface, its clock
};
inline constexpr std::array<std::string_view, 15> kSignalNames{"wheel",          "flywheel",      "pressure",         "maneuver", "demand",
                                                               "slip_reference", "arm",           "weight_on_wheels", "law",      "heartbeat",
                                                               "emergency_stop", "valve_command", "valve_current",    "valve",    "controller"};

enum class Kind : std::uint8_t {
    // of a frame
    drop,
    delay,
    jitter,
    corrupt,
    replayed,
    duplicated,
    reordered,
    wrong_counter,
    // of a value that is sent in sound frames
    freeze,
    bias,
    noise,
    spike,
    saturation,
    missing_tooth,
    wrong_sign,
    // of a valve
    stuck,
    slow,
    leaking,
    // of clocks, loop and link
    clock_step,
    overrun,
    bus_off,
};
inline constexpr std::array<std::string_view, 21> kKindNames{
    "drop",  "delay",      "jitter",        "corrupt",    "replayed", "duplicated", "reordered", "wrong_counter", "freeze",  "bias",   "noise",
    "spike", "saturation", "missing_tooth", "wrong_sign", "stuck",    "slow",       "leaking",   "clock_step",    "overrun", "bus_off"};

[[nodiscard]] constexpr std::string_view name(Signal signal) {
    return kSignalNames[static_cast<std::size_t>(signal)];
}
[[nodiscard]] constexpr std::string_view name(Kind kind) {
    return kKindNames[static_cast<std::size_t>(kind)];
}
[[nodiscard]] constexpr bool of_frame(Kind kind) {
    return kind <= Kind::wrong_counter;
}
/// Whether the fault changes the sequencer's command itself, in an undamaged frame: obeying it is right.
[[nodiscard]] constexpr bool changes_wish(Signal signal) {
    return signal >= Signal::demand && signal <= Signal::law;
}

struct Pair {
    Signal signal;
    Kind kind;
    bool operator==(const Pair&) const = default;
};
/// Every signal with each kind that it can have.
[[nodiscard]] std::span<const Pair> catalogue();

/// One fault. The class that implements a kind defines the meaning of `strength` and `share`.
struct Fault {
    Pair what{};
    double strength = 0.0;  ///< 0 to 1, uniform
    double share = 1.0;     ///< of frames or periods that are affected: 0.02 to 1, uniform in its logarithm; 1 for many faults
    bool negative = false;  ///< sign of a bias, a spike or a step; the second variant of a kind that has two
    double lasts_s = 0.0;   ///< 5 ms to 1 s, uniform in its logarithm, or kForGood
    static constexpr double kForGood = 1e9;
};

/// Draws a fault; half of all faults are permanent.
[[nodiscard]] Fault draw(Pair what, rig::Random& random);

/// Interpolates from `low` to `high`, both above 0, in their logarithm; `strength`: 0 to 1.
[[nodiscard]] double between(double low, double high, double strength);

}  // namespace faults
