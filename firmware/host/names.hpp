/// States and faults by name, for logs and reports: the words of the DBC's value tables.
#pragma once

#include <string_view>
#include <vector>

#include "firmware/control/types.hpp"

namespace antiskid::rt {

[[nodiscard]] std::string_view name(control::State state);
[[nodiscard]] std::string_view name(control::Fault fault);

/// In the order of their numbers.
[[nodiscard]] std::vector<std::string_view> names(control::FaultSet faults);

}  // namespace antiskid::rt
