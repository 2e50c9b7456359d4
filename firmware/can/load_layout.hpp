/// Builds the Layout from the two files that a rig owner edits: a DBC (messages and signals) and a binding (the role of each).
#pragma once

#include <filesystem>

#include "firmware/can/layout.hpp"

namespace antiskid::can {

/// Largest values that the fields must be able to represent: brake pressure and demand, and valve current.
struct RequiredRange {
    double pressure_Pa = 0.0;
    double current_mA = 0.0;
};

/// Throws settings::Error for anything missing, unknown, contradictory, overlapping, in a wrong unit or too narrow; its text names file, line and key
/// (or message and signal) and says what would be right. docs/user/can.md has the keys of the binding.
[[nodiscard]] Layout load_layout(const std::filesystem::path& dbc, const std::filesystem::path& binding, const RequiredRange& required = {});

}  // namespace antiskid::can
