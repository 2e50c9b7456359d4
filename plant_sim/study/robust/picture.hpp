/// The picture of a campaign on drawn plants.
#pragma once

#include <filesystem>
#include <vector>

#include "plant_sim/study/robust/report.hpp"

namespace robust {

/// A panel a family, a line a law: J_mu of every stop, worst first, with crosses at those that ended safe. Throws std::runtime_error as
/// study::run_gnuplot.
void draw_j_mu(const Plan& plan, const std::vector<Row>& rows, const std::vector<Summary>& summaries,
               const std::filesystem::path& png);

}  // namespace robust
