/// Makes the Layout from the two files a rig owner edits: a DBC (messages and signals) and a binding (which
/// of them is what).
#pragma once

#include <filesystem>

#include "firmware/can/layout.hpp"

namespace antiskid::can {

/// Reads and checks both files whole. Throws settings::Error, whose text names file, line and key (or message
/// and signal) and says what would be right, for whatever is missing, unknown, contradictory, overlapping, in
/// a wrong unit or too narrow. docs/can.md has the keys of the binding.
[[nodiscard]] Layout load_layout(const std::filesystem::path& dbc, const std::filesystem::path& binding);

}  // namespace antiskid::can
