/// The names that logs and reports give to states and faults; the same words as in the enumerations and the DBC's value tables.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware/control/types.hpp"

namespace antiskid::rt {

/// "unknown" for a number outside the enumeration.
[[nodiscard]] std::string_view name(control::State state);
[[nodiscard]] std::string_view name(control::Fault fault);

/// In the order of their numbers.
[[nodiscard]] std::vector<std::string_view> names(control::FaultSet faults);

}  // namespace antiskid::rt
