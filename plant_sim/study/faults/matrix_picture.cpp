#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "plant_sim/study/faults/report.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

namespace faults {

void draw_matrix(const FaultPlan& plan, std::span<const Row> rows, const std::filesystem::path& png) {
    const std::size_t columns = kPhaseNames.size() * plan.surfaces.size();
    const std::span<const Pair> pairs = catalogue();
    constexpr int kNothing = -1;
    std::vector<int> worst(pairs.size() * columns, kNothing);
    for (const Row& row : rows) {
        const auto pair = static_cast<std::size_t>(std::find(pairs.begin(), pairs.end(), row.run.fault.what) - pairs.begin());
        const std::size_t column = static_cast<std::size_t>(row.run.phase) * plan.surfaces.size() + row.run.surface;
        int& cell = worst[pair * columns + column];
        cell = std::max(cell, static_cast<int>(row.result.verdict.outcome));
    }
    std::string script = "$cells << EOD\n";
    // Cells that were not run, too: gnuplot draws an image of a whole grid only.
    for (std::size_t i = 0; i < worst.size(); ++i)
        fmt::format_to(std::back_inserter(script), "{} {} {}\n", i % columns, i / columns, worst[i] == kNothing ? "NaN" : std::to_string(worst[i]));
    script += "EOD\nset ytics (";
    for (std::size_t i = 0; i < pairs.size(); ++i)
        fmt::format_to(std::back_inserter(script), "{}'{} {}' {}", i == 0 ? "" : ", ", name(pairs[i].signal), name(pairs[i].kind), i);
    script += ")\nset xtics (";
    const auto width = static_cast<double>(plan.surfaces.size());
    for (std::size_t i = 0; i < kPhaseNames.size(); ++i) {
        const double left = static_cast<double>(i) * width - 0.5;
        fmt::format_to(std::back_inserter(script), "{}'{}' {}", i == 0 ? "" : ", ", kPhaseNames[i], left + 0.5 * width);
    }
    script += ")\n";
    for (std::size_t i = 1; i < kPhaseNames.size(); ++i)
        fmt::format_to(std::back_inserter(script), "set arrow from {0}, graph 0 to {0}, graph 1 nohead front lc rgb '#ffffff' lw 2\n",
                       static_cast<double>(i) * width - 0.5);
    for (std::size_t i = 1; i < pairs.size(); ++i) {
        if (pairs[i].signal != pairs[i - 1].signal)
            fmt::format_to(std::back_inserter(script),
                           "set arrow from graph 0, first {0} to graph 1, first {0} nohead front lc rgb "
                           "'#ffffff' lw 2\n",
                           static_cast<double>(i) - 0.5);
    }
    std::string surfaces;
    for (const Surface& surface : plan.surfaces) surfaces += (surfaces.empty() ? "" : ", ") + surface.name;
    script += fmt::format(
        R"(unset grid
set xrange [-0.5:{}]
set yrange [{}:-0.5]
set tics scale 0 out nomirror font ',9'
set termoption noenhanced
set border lc rgb '#999999'
set palette defined (0 '#9cc9a4', 1 '#f0c75e', 2 '#6f9ec9', 3 '#c0262d') maxcolors 4
set cbrange [-0.5:3.5]
set cbtics ('handled' 0, 'degraded' 1, 'safe' 2, 'UNSAFE' 3)
set title {}
plot $cells using 1:2:3 with image notitle
)",
        static_cast<double>(columns) - 0.5, static_cast<double>(pairs.size()) - 0.5,
        pictures::gnuplot_quoted(
            fmt::format("{} runs, seed {}: the worst outcome of each cell; in each phase from left to right {}", rows.size(), plan.seed, surfaces)));
    constexpr int kWidth = 1150;
    constexpr int kHeight = 1900;
    pictures::run_gnuplot(png, kWidth, kHeight, script);
}

}  // namespace faults
