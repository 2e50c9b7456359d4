/// States and faults by name, for logs, reports and summaries: the words of the DBC's value tables.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware/can/value_names.hpp"

namespace antiskid::can {

[[nodiscard]] inline std::string_view name(control::State state) {
    return kStateNames.at(static_cast<std::size_t>(state));
}
[[nodiscard]] inline std::string_view name(control::Fault fault) {
    return kFaultNames.at(static_cast<std::size_t>(fault));
}

/// In the order of their numbers.
[[nodiscard]] inline std::vector<std::string> fault_names(control::FaultSet faults) {
    std::vector<std::string> names;
    for (std::uint8_t i = 0; i < control::kFaultCount; ++i)
        if (const auto fault = static_cast<control::Fault>(i); faults.contains(fault)) names.emplace_back(name(fault));
    return names;
}

}  // namespace antiskid::can
