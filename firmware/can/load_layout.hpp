/// Makes the Layout from the two files a rig owner edits: a DBC (messages and signals) and a binding (which
/// of them is what).
#pragma once

#include <filesystem>

#include "firmware/can/layout.hpp"

namespace antiskid::can {

/// What the fields of brake pressure and demand, and of the valve's current, must be able to say on a rig.
struct Reach {
    double pressure_Pa = 0.0;
    double current_mA = 0.0;
};

/// Reads and checks both files whole. Throws settings::Error, whose text names file, line and key (or message
/// and signal) and says what would be right, for whatever is missing, unknown, contradictory, overlapping, in
/// a wrong unit or too narrow. docs/user/can.md has the keys of the binding.
[[nodiscard]] Layout load_layout(const std::filesystem::path& dbc, const std::filesystem::path& binding, const Reach& reach = {});

}  // namespace antiskid::can
