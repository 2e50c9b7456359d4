#include "rig_bridge/pictures/map.hpp"

#include <fmt/format.h>

#include <array>
#include <iterator>

#include "rig_bridge/pictures/gnuplot.hpp"
#include "rig_bridge/pictures/series_text.hpp"

namespace pictures {

namespace {

double step(const Range& range, std::size_t count) {
    return (range[1] - range[0]) / static_cast<double>(count - 1);
}

std::string cells(const Map& map) {
    const std::size_t rows = map.values.size() / map.columns;
    std::string out;
    for (std::size_t row = 0; row < rows; ++row) {
        const double y = map.y[0] + step(map.y, rows) * static_cast<double>(row);
        for (std::size_t column = 0; column < map.columns; ++column)
            fmt::format_to(std::back_inserter(out), "{:.7g} {:.7g} {}\n", map.x[0] + step(map.x, map.columns) * static_cast<double>(column), y,
                           number_text(map.values[row * map.columns + column], "NaN"));
        out += "\n";
    }
    return gnuplot_block("cells", out);
}

/// To the outer edges of the first and the last cell.
std::string axis(char name, const Range& range, double step, bool downwards) {
    const double low = range[0] - 0.5 * step;
    const double high = range[1] + 0.5 * step;
    return fmt::format("set {}range [{:.8g}:{:.8g}]\n", name, downwards ? high : low, downwards ? low : high);
}

/// `line`: from and to where, with the place to fill in.
std::string names(char axis, const Names& names, const char* line) {
    if (names.names.empty()) return {};
    std::string out = fmt::format("unset grid\nset {}tics scale 0 out nomirror font ',9' (", axis);
    for (std::size_t i = 0; i < names.names.size(); ++i)
        fmt::format_to(std::back_inserter(out), "{}{} {:.7g}", i == 0 ? "" : ", ", gnuplot_quoted(names.names[i].text), names.names[i].at);
    out += ")\n";
    for (const double at : names.lines) out += "set arrow " + fmt::format(fmt::runtime(line), at) + " nohead front lc rgb '#ffffff' lw 2\n";
    return out;
}

/// Tints of green, orange and blue, and vermillion as it is.
constexpr std::array kTints{"#9fd9c5", "#f0c75e", "#7fb8d9", "#d55e00"};

/// Colours, and what stands in `plot` for their legend.
std::string of_classes(const Map& map, std::string& plot) {
    std::string out =
        fmt::format("unset colorbox\nset cbrange [-0.5:{}.5]\nset palette maxcolors {} defined (", map.classes.size() - 1, map.classes.size());
    for (std::size_t i = 0; i < map.classes.size(); ++i) {
        fmt::format_to(std::back_inserter(out), "{}{} '{}'", i == 0 ? "" : ", ", i, kTints.at(i));
        fmt::format_to(std::back_inserter(plot), ", keyentry with boxes fs solid noborder lc rgb '{}' title {}", kTints.at(i),
                       gnuplot_quoted(map.classes[i]));
    }
    return out + ")\n";
}

std::string of_quantity(const Map& map, std::string& plot) {
    plot += ", $contours using 1:2 with lines lw 1 lc rgb '#444444' notitle";
    return fmt::format(
        "set contour base\nset cntrparam levels incremental {0:.7g},{2:.7g},{1:.7g}\nunset surface\nset table $contours\nsplot $cells\nunset table\n"
        "set palette defined (0 '#ffffff', 0.4 '#c9dcee', 1 '#7fa8cf')\nset cbrange [{0:.7g}:{1:.7g}]\nset cblabel {3}\n",
        map.value_range[0], map.value_range[1], map.contour_step, gnuplot_quoted(map.value_label));
}

}  // namespace

void draw(const Map& map, int height, const std::filesystem::path& png) {
    const std::size_t rows = map.values.size() / map.columns;
    std::string plot = "plot $cells using 1:2:3 with image notitle";
    std::string script = std::string("set termoption noenhanced\n") + kLegend + cells(map);
    script += axis('x', map.x, step(map.x, map.columns), false) + axis('y', map.y, step(map.y, rows), !map.row_names.names.empty());
    script += fmt::format("set title {}\nset xlabel {}\nset ylabel {}\n", gnuplot_quoted(map.title), gnuplot_quoted(map.x_label),
                          gnuplot_quoted(map.y_label));
    script += names('x', map.column_names, "from first {0}, graph 0 to first {0}, graph 1");
    script += names('y', map.row_names, "from graph 0, first {0} to graph 1, first {0}");
    script += map.classes.empty() ? of_quantity(map, plot) : of_classes(map, plot);
    for (std::size_t i = 0; i < map.points.size(); ++i) {
        const std::string name = fmt::format("points{}", i);
        script += series_block(name, map.points[i]);
        plot += ", " + series_plot(name, map.points[i]);
    }
    run_gnuplot(png, 1100, height, script + plot + "\n");
}

}  // namespace pictures
