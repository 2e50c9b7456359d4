/// Validates a plan.
#pragma once

#include "rig_bridge/rig/sequencer.hpp"

namespace rig {

/// Throws std::invalid_argument naming the plan's member, its value and what would be right.
void check(const Plan& plan);

}  // namespace rig
