#include "firmware/host/names.hpp"

#include <cstdint>

#include "firmware/can/value_names.hpp"

namespace antiskid::rt {

std::string_view name(const control::State state) {
    return can::kStateNames.at(static_cast<std::size_t>(state));
}

std::string_view name(const control::Fault fault) {
    return can::kFaultNames.at(static_cast<std::size_t>(fault));
}

std::vector<std::string_view> names(const control::FaultSet faults) {
    std::vector<std::string_view> result;
    for (std::uint8_t number = 0; number < control::kFaultCount; ++number)
        if (const auto fault = static_cast<control::Fault>(number); faults.contains(fault))
            result.push_back(name(fault));
    return result;
}

}  // namespace antiskid::rt
