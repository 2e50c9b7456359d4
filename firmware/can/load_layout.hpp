/// Builds the Layout from the two files that a rig owner edits: a DBC (messages and signals) and a binding (the role of each).
#pragma once

#include <filesystem>

#include "firmware/can/layout.hpp"

namespace antiskid::can {

/// What the fields must be able to represent: a value beyond a field's end is sent as that end, and nobody can tell. 0: no requirement.
struct RequiredRange {
    struct Shaft {
        double radps = 0.0;  ///< of a reported speed
        double edges = 0.0;  ///< between two frames that are both used, of a counter
    };
    struct Ends {
        double min = 0.0, max = 0.0;
    };
    double pressure_Pa = 0.0;  ///< brake pressure and demand
    double current_mA = 0.0;   ///< of the valve, and the open-loop command
    Shaft wheel{}, flywheel{};
    Ends vertical_N{}, longitudinal_N{}, brake_torque_Nm{};  ///< load cells
};

/// Throws settings::Error for anything missing, unknown, contradictory, overlapping, in a wrong unit or too narrow; its text names file, line and key
/// (or message and signal) and says what would be right. docs/user/can.md has the keys of the binding.
[[nodiscard]] Layout load_layout(const std::filesystem::path& dbc, const std::filesystem::path& binding, const RequiredRange& required = {});

}  // namespace antiskid::can
