/// Measured quantities and commands of the rig's PLC, in SI units, independent of the registers. Addresses and coding: register_map.hpp,
/// config/registers.toml.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace rig {

/// Input registers: read by the bridge, written by the PLC.
enum class Measured : std::uint8_t {
    map_version,            ///< must match the map, otherwise nothing else is used
    plc_watchdog,           ///< counts up, modulo 65536, at least every 100 ms while the PLC runs
    plc_state,              ///< a PlcState
    applied_commit,         ///< commit number of the last accepted command; 0: none
    rejected_commit,        ///< that of the last rejected command (out of range, or not allowed in this state); 0: none
    interlocks,             ///< bits, see Interlock; 1: good
    flywheel_speed_mps,     ///< rim speed
    sledge_position_m,      ///< 0 retracted; wheel and rim touch at the PLC's own contact position
    wheel_on_rim,           ///< 0 or 1
    loading_force_N,        ///< of the loading device's actuator, the value that its controller uses
    vertical_load_N,        ///< load cell
    longitudinal_force_N,   ///< load cell, positive when the tyre brakes the flywheel
    brake_torque_Nm,        ///< load cell
    brake_temperature_C,    ///< thermocouple
    hydraulic_pressure_Pa,  ///< supply
};
inline constexpr std::size_t kMeasuredCount = 15;

/// Holding registers: written by the bridge. Everything but the watchdog takes effect, all at once, when `commit`
/// changes to a value other than 0.
enum class Commanded : std::uint8_t {
    bridge_watchdog,     ///< must change within the PLC's watchdog time, otherwise the PLC trips
    drive_enable,        ///< 0 or 1
    flywheel_speed_mps,  ///< set-point of the drive
    sledge_advance,      ///< 0: retract, 1: to the rim
    load_enable,         ///< 0: contact force only, 1: the law below
    load_base_N,         ///< m g of eq. (2), or the constant force
    load_lift_Ns2pm2,    ///< rho S C_l / 2 of eq. (2); 0: constant
    reset,               ///< a change from 0 to 1 leaves `tripped` if every interlock is good
    commit,
};
inline constexpr std::size_t kCommandedCount = 9;

/// Bits of Measured::interlocks, numbered as here; the map gives their places in the register.
enum class Interlock : std::uint8_t { emergency_stop_clear, guard_closed, hydraulics_ready, drive_healthy };
inline constexpr std::size_t kInterlockCount = 4;

enum class PlcState : std::uint8_t {
    ready,    ///< follows commands
    tripped,  ///< an interlock opened or the bridge's watchdog stopped: drive off, sledge back, until reset
};

using MeasuredValues = std::array<double, kMeasuredCount>;
using CommandedValues = std::array<double, kCommandedCount>;

[[nodiscard]] constexpr double& at(MeasuredValues& v, Measured q) {
    return v[static_cast<std::size_t>(q)];
}
[[nodiscard]] constexpr double at(const MeasuredValues& v, Measured q) {
    return v[static_cast<std::size_t>(q)];
}
[[nodiscard]] constexpr double& at(CommandedValues& v, Commanded q) {
    return v[static_cast<std::size_t>(q)];
}
[[nodiscard]] constexpr double at(const CommandedValues& v, Commanded q) {
    return v[static_cast<std::size_t>(q)];
}

[[nodiscard]] constexpr std::string_view name(Measured q) {
    constexpr std::array<std::string_view, kMeasuredCount> kNames{"map_version",     "plc_watchdog",      "plc_state",         "applied_commit",
                                                                  "rejected_commit", "interlocks",        "flywheel_speed",    "sledge_position",
                                                                  "wheel_on_rim",    "loading_force",     "vertical_load",     "longitudinal_force",
                                                                  "brake_torque",    "brake_temperature", "hydraulic_pressure"};
    return kNames[static_cast<std::size_t>(q)];
}
[[nodiscard]] constexpr std::string_view name(Commanded q) {
    constexpr std::array<std::string_view, kCommandedCount> kNames{
        "bridge_watchdog", "drive_enable", "flywheel_speed", "sledge_advance", "load_enable", "load_base", "load_lift", "reset", "commit"};
    return kNames[static_cast<std::size_t>(q)];
}
[[nodiscard]] constexpr std::string_view name(Interlock i) {
    constexpr std::array<std::string_view, kInterlockCount> kNames{"emergency_stop_clear", "guard_closed", "hydraulics_ready", "drive_healthy"};
    return kNames[static_cast<std::size_t>(i)];
}

}  // namespace rig
