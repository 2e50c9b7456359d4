/// The summary of a maneuver in one process, with the same verdicts as rig-bridge's.
#pragma once

#include <vector>

#include "plant_sim/endurance/test_cell.hpp"
#include "rig_bridge/record/summary.hpp"
#include "rig_bridge/rig/acceptance.hpp"

namespace endurance {

/// `head`: what was known before; its cumulative energy is that before this maneuver. `bands`: of the scenario; empty: none.
[[nodiscard]] rig::record::Summary summary_of(const rig::record::Summary& head, const Outcome& outcome, const std::vector<rig::Band>& bands);

}  // namespace endurance
