/// Everything that is read from files before the rig moves.
#pragma once

#include <string>

#include "firmware/can/layout.hpp"
#include "rig_bridge/bridge/options.hpp"
#include "rig_bridge/bridge/translate.hpp"
#include "rig_bridge/record/meter.hpp"
#include "rig_bridge/rig/register_map.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace rig::bridge {

struct BridgeSetup {
    RigOptions options;
    Scenario scenario;
    antiskid::can::Layout layout;
    RegisterMap map;
    record::MeterParameters meter;
    Freshness limits;
    std::string config_hash;  ///< of scenario, sequencer, rig, layout, register map and bridge.toml
};

/// Throws settings::Error or std::invalid_argument that names the error and what would be right. `also`: further files for the hash.
[[nodiscard]] BridgeSetup load_setup(const RigOptions& options, const std::vector<std::filesystem::path>& also = {});

}  // namespace rig::bridge
