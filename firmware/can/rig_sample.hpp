/// The values that a rig sends in one period, in SI units: the counterpart of control::Sensors.
#pragma once

#include <cstdint>

#include "firmware/control/types.hpp"

namespace antiskid::can {

/// Output of one toothed encoder, and the speed that a sensor reporting speed would send instead.
struct SpeedSample {
    std::uint32_t edge_count = 0;  ///< rolls over
    control::Time edge_time{};     ///< sensor's clock
    float speed_radps = 0.0F;      ///< for layouts whose sensor reports speed
};

struct ManeuverSample {
    control::Law law = control::Law::wheel_slip;
    bool arm = false;
    bool weight_on_wheels = false;
    float demand_Pa = 0.0F;
    float slip_reference = 0.0F;
    float deceleration_mps2 = 0.0F;
    float current_mA = 0.0F;
};

/// Telemetry of the rig; no input of the controller.
struct LoadCellSample {
    float vertical_N = 0.0F;
    float longitudinal_N = 0.0F;
    float brake_torque_Nm = 0.0F;
    control::Time age{};  ///< of the reading when it is sent; 0 if the layout has no such signal

    [[nodiscard]] bool operator==(const LoadCellSample&) const = default;
};

/// Telemetry of the rig bridge; no input of the controller.
struct ManeuverStateSample {
    std::uint8_t phase = 0;    ///< index in kPhaseNames (value_names.hpp)
    std::uint32_t number = 0;  ///< of the maneuver in its campaign; sent modulo its field
    float brake_temperature_C = 0.0F;
};

struct RigSample {
    SpeedSample wheel;
    SpeedSample flywheel;
    float pressure_Pa = 0.0F;
    ManeuverSample maneuver;
    LoadCellSample load_cells;
    ManeuverStateSample maneuver_state;
    bool emergency_stop = false;
};

}  // namespace antiskid::can
