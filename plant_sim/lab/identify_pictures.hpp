/// The pictures of rig-lab identify: what was measured, what was fitted, and what is left.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plant_sim/study/identification/identified.hpp"
#include "rig_bridge/rig/tyre.hpp"

namespace plant_sim::lab {

/// The curve of every surface; those whose names are `strong`, drawn so and called identified.
void draw_surfaces(const std::vector<rig::Surface>& surfaces, const std::vector<std::string>& strong, const std::filesystem::path& png);

/// Into `directory`, each beside the CSV that it is drawn from: static_map.png, valve_NAME.png for every valve recording, wheel.png and
/// friction_SURFACE.png where there are those fits. Returns their names.
std::vector<std::string> draw_identified(const identification::Identified& found, const std::filesystem::path& directory);

}  // namespace plant_sim::lab
