/// Fig. 13 and 14 of the paper from a sweep.
#pragma once

#include <filesystem>

#include "plant_sim/study/sweep/summary.hpp"

namespace sweep {

/// Mean J_mu and distance over the mean energy of the brake (top) and of the tyre (bottom). Throws std::runtime_error as run_gnuplot.
void draw_fig13(const Summary& summary, const std::filesystem::path& png);
/// The two energies against each other, and both over the reference.
void draw_fig14(const Summary& summary, const std::filesystem::path& png);

}  // namespace sweep
