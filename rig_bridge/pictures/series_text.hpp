/// Parts of gnuplot scripts shared by figures and maps.
#pragma once

#include <string>

#include "rig_bridge/pictures/figure.hpp"

namespace pictures {

/// Above the axes, where it covers nothing.
inline constexpr const char* kLegend = "set key tmargin center horizontal Left reverse samplen 2 width 1\n";

/// The number as text, or `missing` for NaN.
[[nodiscard]] std::string number_text(double value, const char* missing);
/// The block `$name` of a series.
[[nodiscard]] std::string series_block(const std::string& name, const Series& series);
/// The element of gnuplot's `plot` command for a series.
[[nodiscard]] std::string series_plot(const std::string& name, const Series& series);

}  // namespace pictures
