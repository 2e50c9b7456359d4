/// The bus layout: message and field of every value that controller and rig exchange. One immutable table, built at start from a DBC and a binding
/// (load_layout.hpp), or compiled in on a microcontroller. Fixed size, trivially copyable, freestanding.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "firmware/can/e2e.hpp"
#include "firmware/can/signal.hpp"
#include "firmware/control/types.hpp"

namespace antiskid::can {

/// What a message is for. One message has one role.
enum class Role : std::uint8_t {
    // rig to controller
    wheel,
    flywheel,
    pressure,
    maneuver,
    rig_heartbeat,
    emergency_stop,
    sync,
    load_cells,      ///< telemetry of the rig; the controller ignores it
    maneuver_state,  ///< telemetry of the rig bridge; the controller ignores it
    // controller to rig
    valve,
    status,
    faults,
    road,
    controller_heartbeat,
};
inline constexpr std::size_t kRoleCount = 14;

/// The name of the role's table in the binding.
[[nodiscard]] constexpr std::string_view name(Role role) {
    constexpr std::array<std::string_view, kRoleCount> kNames{
        "wheel",      "flywheel",       "pressure", "maneuver", "rig_heartbeat", "emergency_stop", "sync",
        "load_cells", "maneuver_state", "valve",    "status",   "faults",        "road",           "controller_heartbeat"};
    return kNames[static_cast<std::size_t>(role)];
}

struct Message {
    std::uint16_t id = 0;     ///< 11-bit identifier
    std::uint8_t length = 0;  ///< bytes; a frame of any other length is refused
    bool bound = false;       ///< false: this layout has no such message
    control::Time period{};   ///< expected cycle time; 0: sent on an event
    E2e protection;
};

/// Either edge_count and edge_time, or speed_radps.
struct SpeedSignals {
    control::SpeedSource source = control::SpeedSource::edges;
    Signal edge_count;
    Signal edge_time;  ///< in ns
    Signal speed_radps;
};

struct ManeuverSignals {
    Signal law;
    Signal arm;
    Signal weight_on_wheels;
    Signal demand_Pa;
    Signal slip_reference;
    Signal deceleration_mps2;
    Signal current_mA;

    /// Whether the field is wide enough for the code; a narrower one would truncate it to another law's code.
    [[nodiscard]] constexpr bool has(control::Law code) const { return static_cast<std::uint64_t>(code) <= law.mask(); }
};

struct LoadCellSignals {
    Signal vertical_N;
    Signal longitudinal_N;
    Signal brake_torque_Nm;
    Signal age_ns;  ///< optional
};

struct ManeuverStateSignals {
    Signal phase;
    Signal number;
    Signal brake_temperature_C;
};

struct StatusSignals {
    Signal state;
    Signal slip;
    Signal slip_reference;
    Signal speed_mps;
};

struct RoadSignals {
    Signal peak_slip;
    Signal grip_N;
    Signal confidence;
};

struct Layout {
    std::array<Message, kRoleCount> messages{};
    SpeedSignals wheel;
    SpeedSignals flywheel;
    Signal pressure_Pa;
    ManeuverSignals maneuver;
    Signal sync_counter;
    LoadCellSignals load_cells;
    ManeuverStateSignals maneuver_state;
    Signal valve_current_mA;
    StatusSignals status;
    std::array<Signal, control::kFaultCount> faults{};  ///< one bit each, in the order of control::Fault
    RoadSignals road;

    [[nodiscard]] constexpr const Message& operator[](Role role) const { return messages[static_cast<std::size_t>(role)]; }
    [[nodiscard]] constexpr Message& operator[](Role role) { return messages[static_cast<std::size_t>(role)]; }
};

}  // namespace antiskid::can
