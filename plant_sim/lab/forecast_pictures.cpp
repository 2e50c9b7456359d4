#include "plant_sim/lab/forecast_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "rig_bridge/pictures/gnuplot.hpp"

namespace plant_sim::lab {

namespace {

constexpr const char* kStyleOfForecasts = "set lmargin 11\nset rmargin 4\n";

std::string landings_text(const wear::Forecast& f) {
    const auto text = [](const std::optional<int>& landings) { return landings ? fmt::format("{}", *landings) : std::string("beyond the horizon"); };
    if (f.already_crossed()) return "below the limit already";
    return fmt::format("landings left: {} (10 %), {} (50 %), {} (90 %)", text(f.landings_left[0]), text(f.landings_left[1]),
                       text(f.landings_left[2]));
}

}  // namespace

void draw_forecast(const wear::Campaign& recorded, const wear::Forecast& f, double limit, const std::filesystem::path& png) {
    std::string script = kStyleOfForecasts;
    script += "set xlabel 'cumulative brake energy (MJ)'\nset ylabel 'mean brake friction'\n$points << EOD\n";
    double min = limit;
    double max = limit;
    for (const wear::Point& p : recorded.points) {
        fmt::format_to(std::back_inserter(script), "{:.6f} {:.7f}\n", p.c_e_J * 1e-6, p.mean_friction);
        min = std::min(min, p.mean_friction);
        max = std::max(max, p.mean_friction);
    }
    script += "EOD\n$fan << EOD\n";
    for (const wear::FanPoint& p : f.fan)
        fmt::format_to(std::back_inserter(script), "{:.6f} {:.7f} {:.7f} {:.7f}\n", p.c_e_J * 1e-6, p.friction[0], p.friction[1], p.friction[2]);
    const double last_MJ = f.fan.empty() ? f.c_e_J * 1e-6 : f.fan.back().c_e_J * 1e-6;
    const double room = max - min;
    script += fmt::format("EOD\nset xrange [0:{}]\nset yrange [{}:{}]\n", last_MJ, min - 0.45 * room, max + 0.08 * room);
    int arrow = 1;
    for (std::size_t q = 0; q < f.crossing_J.size(); ++q) {
        const std::optional<double> at_J = f.crossing_J.at(q);
        if (!at_J || f.already_crossed()) continue;
        fmt::format_to(std::back_inserter(script), "set arrow {} from {}, graph 0 to {}, first {} nohead dt {} lw 1.5 lc rgb '#a61c3c'\n", arrow++,
                       *at_J * 1e-6, *at_J * 1e-6, limit, q == 1 ? 1 : 2);
    }
    script += fmt::format(
        "set title {} noenhanced\nset key top right\n"
        "plot $fan using 1:2:4 with filledcurves lc rgb '#c9dcee' title '10 to 90 % of the mean friction', "
        "\\\n"
        "     $fan using 1:3 with lines lw 2 lc rgb '#1f4e79' title '50 %', \\\n"
        "     $points using 1:2 with points pt 7 ps 0.5 lc rgb '#555555' title 'recorded', \\\n"
        "     {} with lines lw 2 lc rgb '#a61c3c' title 'limit {:.4f}'\n",
        pictures::gnuplot_quoted(landings_text(f)), limit, limit);
    pictures::run_gnuplot(png, 1100, 700, script);
}

void draw_health(const wear::Campaign& recorded, const std::vector<wear::Verdict>& verdicts, const std::filesystem::path& png) {
    std::string script = kStyleOfForecasts;
    script += "$health << EOD\n";
    double max = 1.2;
    for (std::size_t i = 0; i < verdicts.size(); ++i) {
        const wear::Verdict& v = verdicts[i];
        max = std::max(max, v.statistic * 1.1);
        fmt::format_to(std::back_inserter(script), "{} {:.7f} {:.7f} {:.7f} {:.5f} {}\n", i + 1, recorded.points[i].mean_friction,
                       v.expected - 2.0 * v.deviation, v.expected + 2.0 * v.deviation, v.statistic, static_cast<int>(v.condition));
    }
    const auto flagged =
        std::find_if(verdicts.begin(), verdicts.end(), [](const wear::Verdict& v) { return v.condition == wear::Condition::abnormal; });
    script += "EOD\n";
    if (flagged != verdicts.end())
        script += fmt::format("set arrow 1 from {}, graph 0 to {}, graph 1 nohead dt 2 lc rgb '#a61c3c'\n", flagged - verdicts.begin() + 1,
                              flagged - verdicts.begin() + 1);
    script += fmt::format(
        R"(set xrange [0:{}]
set multiplot layout 2,1 title {} noenhanced
set ylabel 'mean brake friction'
set key top right
plot $health using 1:3:4 with filledcurves lc rgb '#c9dcee' title 'expected, two deviations', \
     $health using 1:($6 < 2 ? $2 : NaN) with points pt 7 ps 0.5 lc rgb '#1f4e79' title 'recorded', \
     $health using 1:($6 == 2 ? $2 : NaN) with points pt 7 ps 0.7 lc rgb '#e58e26' title 'suspect', \
     $health using 1:($6 == 3 ? $2 : NaN) with points pt 7 ps 0.7 lc rgb '#a61c3c' title 'abnormal'
set xlabel 'maneuver'
set ylabel 'statistic (share of its limit)'
set yrange [0:{}]
set key top left
plot $health using 1:5 with lines lw 1.5 lc rgb '#1f4e79' notitle, \
     1 with lines lw 1.5 lc rgb '#a61c3c' title 'abnormal', \
     {} with lines lw 1.5 lc rgb '#e58e26' title 'suspect'
unset multiplot
)",
        verdicts.size() + 1,
        pictures::gnuplot_quoted(flagged == verdicts.end()
                                     ? fmt::format("{} maneuvers, not abnormal", verdicts.size())
                                     : fmt::format("abnormal at maneuver {}: {}", flagged - verdicts.begin() + 1, flagged->reason)),
        std::min(max, 5.0), wear::HealthMonitor::kSuspectFrom);
    pictures::run_gnuplot(png, 1100, 900, script);
}

}  // namespace plant_sim::lab
