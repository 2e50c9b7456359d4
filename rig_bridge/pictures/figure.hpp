/// Figures as data, in one style: drawn by gnuplot, and stored as JSON for charts in a browser.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pictures {

enum class Style { line, dashes, points };

struct Series {
    std::string name = {};
    Style style = Style::line;
    std::size_t colour = 0;  ///< as gnuplot_colour() counts
    double width = 1.6;
    bool in_legend = true;
    std::vector<double> x = {}, y = {};       ///< a NaN in y breaks the line
    std::vector<double> low = {}, high = {};  ///< a band around y; empty: none
    std::vector<std::string> notes = {};      ///< text beside each point; empty: none

    void add(double at, double value) {
        x.push_back(at);
        y.push_back(value);
    }
    void add(double at, double value, double least, double greatest) {
        add(at, value);
        low.push_back(least);
        high.push_back(greatest);
    }
};

/// A horizontal line, e.g. a limit.
[[nodiscard]] Series level(std::string name, double from, double to, double y, std::size_t colour);

using Range = std::array<double, 2>;

struct Chart {
    std::string title = {};
    std::string y_label = {}, x_label = {};  ///< with unit
    std::vector<Series> series = {};
    std::optional<Range> x_range = {}, y_range = {};  ///< none: fitted to the data
    bool logarithmic_x = false, logarithmic_y = false;
    std::vector<double> marks = {};  ///< x of vertical lines
};

struct Figure {
    std::string title = {};
    std::vector<Chart> charts = {};
    int columns = 1;
};

/// Writes NAME.png, NAME.svg and NAME.charts.json. A long series is reduced to the first, last, smallest and largest value of each of 300 parts, so
/// that no peak is lost. Throws std::runtime_error as run_gnuplot().
void draw(Figure figure, const std::filesystem::path& png);

}  // namespace pictures
