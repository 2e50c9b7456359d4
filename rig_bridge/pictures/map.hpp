/// Colour maps of values over two axes, in the style of figure.hpp.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "rig_bridge/pictures/figure.hpp"

namespace pictures {

/// Names on an axis instead of numbers.
struct Names {
    struct Name {
        std::string text;
        double at = 0.0;
    };
    std::vector<Name> names = {};
    std::vector<double> lines = {};  ///< positions of the lines between them
};

struct Map {
    std::string title = {};
    std::string x_label = {}, y_label = {};
    std::size_t columns = 0;                  ///< at least two; also at least two rows
    std::vector<double> values = {};          ///< row by row; NaN: empty
    Range x = {}, y = {};                     ///< positions of first and last column, and of first and last row
    std::vector<std::string> classes = {};    ///< class names, at most four, with values as indices; empty: values are a quantity
    std::string value_label = {};             ///< of a quantity, with unit
    Range value_range = {};                   ///< range of the colours
    double contour_step = 0.0;                ///< distance of contour lines, drawn within value_range
    Names column_names = {}, row_names = {};  ///< named rows are drawn from top to bottom
    std::vector<Series> points = {};
};

/// Writes NAME.png and NAME.svg, `height` pixels high. Throws std::runtime_error as run_gnuplot().
void draw(const Map& map, int height, const std::filesystem::path& png);

}  // namespace pictures
