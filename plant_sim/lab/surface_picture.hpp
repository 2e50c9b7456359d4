/// Fig. 3: friction over slip, eq. (4).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rig_bridge/rig/tyre.hpp"

namespace plant_sim::lab {

/// The curve of every surface; those whose names are `strong`, drawn so and called identified.
void draw_surfaces(const std::vector<rig::Surface>& surfaces, const std::vector<std::string>& strong, const std::filesystem::path& png);

}  // namespace plant_sim::lab
