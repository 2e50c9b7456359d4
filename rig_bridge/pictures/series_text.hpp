/// What figures and maps have in common, in gnuplot's language.
#pragma once

#include <string>

#include "rig_bridge/pictures/figure.hpp"

namespace pictures {

/// Above the axes, where it covers nothing.
inline constexpr const char* kLegend = "set key tmargin center horizontal Left reverse samplen 2 width 1\n";

/// A number, or what stands for none.
[[nodiscard]] std::string number_text(double value, const char* missing);
/// The block `$name` of a series.
[[nodiscard]] std::string series_block(const std::string& name, const Series& series);
/// What stands in `plot` for it.
[[nodiscard]] std::string series_plot(const std::string& name, const Series& series);

}  // namespace pictures
