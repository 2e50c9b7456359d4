/// Pictures of rig-lab identify: measurements, fits and residuals.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plant_sim/study/identification/identified.hpp"
#include "rig_bridge/rig/tyre.hpp"

namespace plant_sim::lab {

/// The curves of all surfaces; those whose names are in `strong` are drawn strong and labelled as identified.
void draw_surfaces(const std::vector<rig::Surface>& surfaces, const std::vector<std::string>& strong, const std::filesystem::path& png);

/// Draws in `directory`, each beside its CSV: static_map.png, valve_NAME.png for each valve recording, wheel.png and friction_SURFACE.png if these
/// were fitted. Returns their names.
std::vector<std::string> draw_identified(const identification::Identified& found, const std::filesystem::path& directory);

}  // namespace plant_sim::lab
