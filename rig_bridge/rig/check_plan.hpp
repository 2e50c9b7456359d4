/// Whether a plan can be run at all.
#pragma once

#include "rig_bridge/rig/sequencer.hpp"

namespace rig {

/// Throws std::invalid_argument naming the member of the plan, what it is and what would be right.
void check(const Plan& plan);

}  // namespace rig
