/// Values over two axes as areas of colour, in the style of figure.hpp.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "rig_bridge/pictures/figure.hpp"

namespace pictures {

/// Names in the place of an axis's numbers.
struct Names {
    struct Name {
        std::string text;
        double at = 0.0;
    };
    std::vector<Name> names = {};
    std::vector<double> lines = {};  ///< that divide them
};

struct Map {
    std::string title = {};
    std::string x_label = {}, y_label = {};
    std::size_t columns = 0;                  ///< two at least, and two rows
    std::vector<double> values = {};          ///< row by row; not a number: nothing there
    Range x = {}, y = {};                     ///< of the first and the last column, of the first and the last row
    std::vector<std::string> classes = {};    ///< that the values count, four at most; none: values are a quantity
    std::string value_label = {};             ///< of a quantity, with unit
    Range value_range = {};                   ///< of its colours
    double contour_step = 0.0;                ///< of its lines, which are drawn within value_range
    Names column_names = {}, row_names = {};  ///< rows with names are drawn downwards
    std::vector<Series> points = {};
};

/// Leaves NAME.png and NAME.svg, `height` pixels high. Throws std::runtime_error as run_gnuplot().
void draw(const Map& map, int height, const std::filesystem::path& png);

}  // namespace pictures
