/// Validates a plan.
#pragma once

#include <filesystem>

#include "rig_bridge/rig/register_map.hpp"
#include "rig_bridge/rig/sequencer.hpp"

namespace rig {

/// Throws std::invalid_argument naming the plan's member, its value and what would be right.
void check(const Plan& plan);

/// What the plan commands must fit into the PLC's registers: found here, not with a turning flywheel. Throws settings::Error naming `file` and the
/// register's key.
void check(const Plan& plan, const RegisterMap& map, const std::filesystem::path& file);

}  // namespace rig
