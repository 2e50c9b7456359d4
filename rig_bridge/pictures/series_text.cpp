#include "rig_bridge/pictures/series_text.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "rig_bridge/pictures/gnuplot.hpp"

namespace pictures {

std::string number_text(double value, const char* missing) {
    return std::isfinite(value) ? fmt::format("{:.6g}", value) : missing;
}

std::string series_block(const std::string& name, const Series& s) {
    std::string rows;
    for (std::size_t i = 0; i < s.x.size(); ++i) {
        rows += fmt::format("{} {}", number_text(s.x[i], "NaN"), number_text(s.y[i], "NaN"));
        if (!s.low.empty()) rows += fmt::format(" {} {}", number_text(s.low[i], "NaN"), number_text(s.high[i], "NaN"));
        rows += s.notes.empty() ? "\n" : fmt::format(" \"{}\"\n", s.notes[i]);
    }
    return gnuplot_block(name, rows);
}

std::string series_plot(const std::string& name, const Series& s) {
    const std::string colour = fmt::format("lc rgb '{}'", gnuplot_colour(s.colour));
    const std::string title = s.in_legend && !s.name.empty() ? "title " + gnuplot_quoted(s.name) : "notitle";
    std::string out;
    if (!s.low.empty()) out += fmt::format("${} using 1:3:4 with filledcurves fs solid 0.25 noborder {} notitle, ", name, colour);
    if (s.style == Style::points) {
        constexpr std::size_t kMany = 20;
        const int kind = std::array{7, 5, 9, 13, 11, 15, 4}.at(s.colour % 7);
        out += fmt::format("${0} using 1:2 with points pt {1} ps {2} {3} notitle, keyentry with points pt {1} ps 1 {3} {4}", name, kind,
                           s.x.size() > kMany ? 0.45 : 0.9, colour, title);
    } else {
        out += fmt::format("${} using 1:2 with lines lw {} {} {} {}", name, s.width, s.style == Style::dashes ? "dt 2" : "dt 1", colour, title);
    }
    if (!s.notes.empty()) out += fmt::format(", ${} using 1:2:3 with labels left offset 0.7,0.5 font ',9' tc rgb '#444444' notitle", name);
    return out;
}

}  // namespace pictures
