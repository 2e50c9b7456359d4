#include "rig_bridge/pictures/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/json.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"
#include "rig_bridge/pictures/series_text.hpp"

namespace pictures {

namespace {

template <typename Value>
void take(std::vector<Value>& values, const std::vector<std::size_t>& places) {
    if (values.empty()) return;
    std::vector<Value> taken;
    taken.reserve(places.size());
    for (const std::size_t i : places) taken.push_back(values[i]);
    values = std::move(taken);
}

void take(Series& s, const std::vector<std::size_t>& places) {
    take(s.x, places);
    take(s.y, places);
    take(s.low, places);
    take(s.high, places);
    take(s.notes, places);
}

/// In order of x, as charts need it.
void sort_by_x(Series& s) {
    std::vector<std::size_t> places(s.x.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    if (std::is_sorted(s.x.begin(), s.x.end())) return;
    std::stable_sort(places.begin(), places.end(), [&](std::size_t a, std::size_t b) { return s.x[a] < s.x[b]; });
    take(s, places);
}

/// Marks what `values` needs of its part [from, to): the first, the last, the least, the greatest, a gap.
void keep_of(const std::vector<double>& values, std::size_t from, std::size_t to, std::vector<char>& kept) {
    std::size_t least = from;
    std::size_t greatest = from;
    std::size_t gap = from;
    for (std::size_t i = from; i < to; ++i) {
        if (std::isnan(values[i])) gap = i;
        if (!(values[i] >= values[least])) least = i;
        if (!(values[i] <= values[greatest])) greatest = i;
    }
    for (const std::size_t i : {from, to - 1, least, greatest, gap}) kept[i] = 1;
}

/// Series with the same x keep the same places, so that a reader sees the values of all at one x.
void thin(Chart& chart) {
    constexpr std::size_t kParts = 300;
    std::vector<char> done(chart.series.size());
    for (std::size_t i = 0; i < chart.series.size(); ++i) {
        if (done[i] != 0) continue;
        const std::vector<double> x = chart.series[i].x;
        std::vector<Series*> alike;
        for (std::size_t k = i; k < chart.series.size(); ++k) {
            if (done[k] != 0 || chart.series[k].x != x) continue;
            done[k] = 1;
            alike.push_back(&chart.series[k]);
        }
        if (x.size() <= 4 * kParts) continue;
        std::vector<char> kept(x.size());
        for (std::size_t part = 0; part < kParts; ++part)
            for (const Series* s : alike) keep_of(s->y, part * x.size() / kParts, (part + 1) * x.size() / kParts, kept);
        std::vector<std::size_t> places;
        for (std::size_t k = 0; k < kept.size(); ++k)
            if (kept[k] != 0) places.push_back(k);
        for (Series* s : alike) take(*s, places);
    }
}

std::string range_text(const std::optional<Range>& range) {
    return range ? fmt::format("[{}:{}]", (*range)[0], (*range)[1]) : "[*:*]";
}

std::string script(const Figure& figure) {
    const std::size_t columns = static_cast<std::size_t>(figure.columns);
    std::string out =
        fmt::format("set termoption noenhanced\nset autoscale fix\nset lmargin 11\nset rmargin 3\n{}set multiplot layout {},{} title {}.\"\\n\"\n",
                    kLegend, (figure.charts.size() + columns - 1) / columns, columns, gnuplot_quoted(figure.title));
    for (std::size_t c = 0; c < figure.charts.size(); ++c) {
        const Chart& chart = figure.charts[c];
        std::string plots;
        for (std::size_t s = 0; s < chart.series.size(); ++s) {
            const std::string name = fmt::format("d{}_{}", c, s);
            out += series_block(name, chart.series[s]);
            plots += (plots.empty() ? "plot " : ", ") + series_plot(name, chart.series[s]);
        }
        out += "unset arrow\n";
        for (const double x : chart.marks)
            out += fmt::format("set arrow from first {0}, graph 0 to first {0}, graph 1 nohead dt 3 lc rgb '#555555'\n", x);
        // Room around the data: by offsets, which are of numbers and no share of a logarithmic axis; that one goes on to its next tic.
        const char* const room = chart.logarithmic_x || chart.logarithmic_y ? "0, 0, 0, 0" : "0, 0, graph 0.06, graph 0.06";
        fmt::format_to(
            std::back_inserter(out),
            "unset logscale\n{}{}set offsets {}\nset title {}\nset xlabel {} offset 0,0.4\nset ylabel {}\nset xrange {}\nset yrange {}\n{}\n",
            chart.logarithmic_x ? "set logscale x\n" : "", chart.logarithmic_y ? "set logscale y\nset autoscale y\n" : "set autoscale yfix\n", room,
            gnuplot_quoted(chart.title), gnuplot_quoted(chart.x_label), gnuplot_quoted(chart.y_label), range_text(chart.x_range),
            range_text(chart.y_range), plots);
    }
    return out + "unset multiplot\n";
}

std::string array_text(const std::vector<double>& values) {
    std::vector<std::string> texts(values.size());
    std::transform(values.begin(), values.end(), texts.begin(), [](double v) { return number_text(v, "null"); });
    return fmt::format("[{}]", fmt::join(texts, ","));
}

std::string range_json(const std::optional<Range>& range) {
    return range ? array_text({(*range)[0], (*range)[1]}) : "null";
}

std::string json_text(const settings::Json& text) {
    return settings::json_line(text);
}

/// Numbers by hand: six digits are a third of what the library would write. A series whose x is that of an earlier one has its place instead.
std::string json_of(const Chart& chart) {
    std::string series;
    for (std::size_t i = 0; i < chart.series.size(); ++i) {
        const Series& s = chart.series[i];
        const auto same = static_cast<std::size_t>(
            std::find_if(chart.series.begin(), chart.series.end(), [&](const Series& other) { return other.x == s.x; }) - chart.series.begin());
        fmt::format_to(std::back_inserter(series), R"({}{{"name":{},"style":"{}","color":"{}","width":{},"legend":{},"x":{},"y":{})",
                       i == 0 ? "" : ",\n", json_text(s.name),
                       s.style == Style::points   ? "points"
                       : s.style == Style::dashes ? "dashes"
                                                  : "line",
                       gnuplot_colour(s.colour), s.width, s.in_legend, same < i ? std::to_string(same) : array_text(s.x), array_text(s.y));
        if (!s.low.empty()) series += ",\"low\":" + array_text(s.low) + ",\"high\":" + array_text(s.high);
        if (!s.notes.empty()) series += ",\"notes\":" + json_text(s.notes);
        series += "}";
    }
    return fmt::format(R"({{"title":{},"x":{},"y":{},"log_x":{},"log_y":{},"x_range":{},"y_range":{},"marks":{},"series":[
{}]}})",
                       json_text(chart.title), json_text(chart.x_label), json_text(chart.y_label), chart.logarithmic_x, chart.logarithmic_y,
                       range_json(chart.x_range), range_json(chart.y_range), array_text(chart.marks), series);
}

}  // namespace

Series level(std::string name, double from, double to, double y, std::size_t colour) {
    return {.name = std::move(name), .style = Style::dashes, .colour = colour, .x = {from, to}, .y = {y, y}};
}

void draw(Figure figure, const std::filesystem::path& png) {
    std::string charts;
    for (Chart& chart : figure.charts) {
        for (Series& s : chart.series) sort_by_x(s);
        thin(chart);
        charts += (charts.empty() ? "" : ",\n") + json_of(chart);
    }
    const int rows = (static_cast<int>(figure.charts.size()) + figure.columns - 1) / figure.columns;
    constexpr int kTitle = 40;
    constexpr int kAlone = 620;
    constexpr int kPanel = 360;
    run_gnuplot(png, 1100, rows == 1 ? kAlone : kTitle + rows * kPanel, script(figure));
    settings::write_file(std::filesystem::path(png).replace_extension(".charts.json"),
                         fmt::format("{{\"title\":{},\"columns\":{},\"charts\":[\n{}]}}\n", json_text(figure.title), figure.columns, charts));
}

}  // namespace pictures
