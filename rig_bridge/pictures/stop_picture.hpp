/// The picture of a stop, like the paper's Fig. 12: speeds, slip, pressures over time, drawn by gnuplot.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pictures {

/// Draws `csv`, a trajectory as text (as Trajectory writes it), into `png`; the vertical line marks `brake_on_s`. With `along_runway`, for one
/// that has the columns of a runway, also friction, available and used, over its length. The picture is whole or not there. Throws
/// std::runtime_error when gnuplot is not installed or fails, with what it said.
void draw_stop(std::string_view csv, const std::filesystem::path& png, const std::string& title, double brake_on_s, bool along_runway = false);

}  // namespace pictures
