/// The controller's faults as summaries have them.
#pragma once

#include <string>
#include <vector>

#include "firmware/can/value_names.hpp"
#include "firmware/control/types.hpp"

namespace rig {

[[nodiscard]] inline std::vector<std::string> fault_names(antiskid::control::FaultSet faults) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < antiskid::control::kFaultCount; ++i) {
        if (faults.contains(static_cast<antiskid::control::Fault>(i)))
            names.emplace_back(antiskid::can::kFaultNames[i]);
    }
    return names;
}

}  // namespace rig
