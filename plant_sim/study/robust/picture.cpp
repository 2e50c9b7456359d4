#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "plant_sim/study/robust/report.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

namespace robust {

namespace {

constexpr const char* kStyle = R"(set style line 1 lc rgb '#1f4e79' lw 2
set style line 2 lc rgb '#c55a11' lw 2
set style line 3 lc rgb '#538135' lw 2
set style line 4 lc rgb '#7f6000' lw 2
set style line 5 lc rgb '#7030a0' lw 2
set key bottom right Left reverse samplen 2 spacing 1.1 font ',10'
set lmargin 8
set rmargin 2
set tmargin 2.6
set bmargin 3.3
set xrange [0:100]
)";

/// An underscore would begin a subscript.
std::string escaped(std::string_view name) {
    std::string text;
    for (const char c : name) text += c == '_' ? std::string("\\_") : std::string(1, c);
    return text;
}

std::vector<Row> worst_first(const std::vector<Row>& rows, const Summary& s) {
    std::vector<Row> own;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(own), [&s](const Row& row) { return row.family == s.family && row.law == s.law; });
    std::stable_sort(own.begin(), own.end(), [](const Row& a, const Row& b) { return a.figures.j_mu < b.figures.j_mu; });
    return own;
}

/// Blocks $all<n> and $safe<n>: share of the stops in %, J_mu.
std::string data(const std::vector<Row>& own, std::size_t n) {
    const auto point = [](double share, double j_mu) { return fmt::format("{:.4f} {:.6f}\n", share, j_mu); };
    std::string all = point(0.0, own.front().figures.j_mu);
    std::string safe;
    for (std::size_t i = 0; i < own.size(); ++i) {
        const double share = 100.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(own.size());
        all += point(share, own[i].figures.j_mu);
        if (own[i].tripped()) safe += point(share, own[i].figures.j_mu);
    }
    all += point(100.0, own.back().figures.j_mu);
    return pictures::gnuplot_block(fmt::format("all{}", n), all) + pictures::gnuplot_block(fmt::format("safe{}", n), safe);
}

}  // namespace

void draw_j_mu(const RobustPlan& plan, const std::vector<Row>& rows, const std::vector<Summary>& summaries, const std::filesystem::path& png) {
    constexpr std::size_t kColumns = 2;
    constexpr int kWidth = 1000, kPanel = 270, kTitle = 50;
    const std::size_t panels = plan.families.size();
    const std::size_t columns = std::min(panels, kColumns), lines = (panels + columns - 1) / columns;
    double min = 0.9, max = 1.0;
    for (const Row& row : rows) {
        min = std::min(min, row.figures.j_mu);
        max = std::max(max, row.figures.j_mu);
    }
    std::string script = kStyle;
    for (std::size_t n = 0; n < summaries.size(); ++n) script += data(worst_first(rows, summaries[n]), n);
    fmt::format_to(std::back_inserter(script), "set yrange [{:.1f}:{:.1f}]\nset multiplot layout {},{} title {}\n", std::floor(min * 10.0) / 10.0,
                   std::ceil(max * 10.0) / 10.0, lines, columns,
                   pictures::gnuplot_quoted(fmt::format("J_{{/Symbol m}} of every stop, worst first: seed {}, slip reference {}", plan.seed,
                                                        plan.basis.uncertainty.slip_reference)));
    for (std::size_t panel = 0; panel < panels; ++panel) {
        std::string plots;
        for (std::size_t n = 0; n < summaries.size(); ++n) {
            const Summary& s = summaries[n];
            if (s.family != plan.families[panel]) continue;
            const std::size_t style = s.law % 5 + 1;
            fmt::format_to(std::back_inserter(plots), "{}$all{} with lines ls {} title '{}, mean {:.3f}' noenhanced", plots.empty() ? "plot " : ", ",
                           n, style, plan.laws[s.law].name, s.mean_j_mu);
            if (s.tripped > 0)
                fmt::format_to(std::back_inserter(plots), ", $safe{} with points ls {} pt 2 ps 1.1 title '{} ended safe'", n, style, s.tripped);
        }
        fmt::format_to(std::back_inserter(script), "set title '{{/:Bold {}}}, {} stops' offset 0,-0.7\nset ylabel '{}'\nset xlabel '{}'\n{}\n",
                       escaped(name(plan.families[panel])), plan.draws_of(plan.families[panel]), panel % columns == 0 ? "J_{/Symbol m}" : "",
                       panel + columns >= panels ? "share of the stops (%)" : "", plots);
    }
    pictures::run_gnuplot(png, columns == 1 ? kWidth * 3 / 4 : kWidth, kTitle + kPanel * static_cast<int>(lines), script + "unset multiplot\n");
}

}  // namespace robust
