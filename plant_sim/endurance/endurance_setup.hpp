/// Inputs of a campaign in one process, read and checked.
#pragma once

#include <filesystem>
#include <string>

#include "firmware/can/layout.hpp"
#include "firmware/control/config.hpp"
#include "plant_sim/plc/served_rig.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace endurance {

struct EnduranceSetup {
    rig::Scenario scenario;
    antiskid::control::Config controller;
    antiskid::can::Layout layout;
    plc::ServedRigOptions machinery;  ///< with a new brake
    std::string config_hash;          ///< of all files read
};

/// Throws settings::Error naming file, line and key, or std::invalid_argument.
[[nodiscard]] EnduranceSetup load_setup(const std::filesystem::path& scenario, const std::filesystem::path& config);

}  // namespace endurance
