/// The pictures of rig-lab identify: what was measured, what was fitted, and what is left.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plant_sim/study/identification/identified.hpp"

namespace plant_sim::lab {

/// Into `directory`, each beside the CSV that it is drawn from: static_map.png, valve_NAME.png for every valve recording, wheel.png and
/// friction_SURFACE.png where there are those fits. Returns their names.
std::vector<std::string> draw_identified(const identification::Identified& found, const std::filesystem::path& directory);

}  // namespace plant_sim::lab
