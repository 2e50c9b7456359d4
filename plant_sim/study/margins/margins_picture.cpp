#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "plant_sim/study/margins/margins_report.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

namespace study::margins {

namespace {

constexpr const char* kStyle = "set grid xtics ytics mxtics lc rgb '#dddddd', lc rgb '#eeeeee'\n";

/// Surfaces in the order in which they appear.
std::vector<std::string> surfaces(const std::vector<StopConditions>& scenarios) {
    std::vector<std::string> names;
    for (const StopConditions& s : scenarios)
        if (std::find(names.begin(), names.end(), s.surface) == names.end()) names.push_back(s.surface);
    return names;
}

std::size_t index_of(const std::vector<std::string>& names, const std::string& name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

/// `plot` of one block per surface, lines broken where a blank line is; the title once where `titled`.
std::string plot(const std::vector<std::string>& names, const char* columns, bool titled) {
    std::string out = "plot ";
    for (std::size_t i = 0; i < names.size(); ++i)
        fmt::format_to(std::back_inserter(out), "{}$s{} using {} with lines lc rgb '{}' lw 1.2 {}", i == 0 ? "" : ", ", i, columns,
                       pictures::gnuplot_colour(i), titled ? "title " + pictures::gnuplot_quoted(names[i]) : std::string("notitle"));
    return out + "\n";
}

std::string blocks(const std::vector<std::string>& bodies) {
    std::string out;
    for (std::size_t i = 0; i < bodies.size(); ++i) out += pictures::gnuplot_block(fmt::format("s{}", i), bodies[i]);
    return out;
}

}  // namespace

void draw_plant(const std::vector<StopConditions>& scenarios, double slip_reference, double speed_mps, const std::filesystem::path& png) {
    constexpr double kFrom_radps = 0.01, kTo_radps = 2000.0;
    constexpr int kPoints = 400;
    const std::vector<std::string> names = surfaces(scenarios);
    std::vector<std::string> bodies(names.size());
    for (const StopConditions& s : scenarios) {
        std::string& body = bodies[index_of(names, s.surface)];
        const OperatingPoint at = operating_point(s.rig, speed_mps, slip_reference);
        double phase = 0.0, before = 0.0;
        bool first = true;
        for (const LocusPoint& p : locus(plant_loop(s.rig.valve, at, Linearisation::full), kFrom_radps, kTo_radps, kPoints)) {
            const double arg = std::arg(p.value);
            if (first) {
                // A stable wheel starts at 0 degrees, an unstable one at -180.
                phase = at.wheel_pole_radps(Linearisation::full) < 0.0 ? -std::abs(arg) : arg;
                first = false;
            } else {
                phase += std::remainder(arg - before, 2.0 * std::numbers::pi);
            }
            before = arg;
            fmt::format_to(std::back_inserter(body), "{:.6g} {:.6g} {:.6g}\n", p.frequency_radps, 20.0 * std::log10(std::abs(p.value)),
                           phase * 180.0 / std::numbers::pi);
        }
        body += "\n";
    }
    std::string script = blocks(bodies) + kStyle;
    script += fmt::format(
        "set logscale x\nset format x '10^{{%L}}'\nset multiplot layout 2,2 title {} noenhanced margins "
        "0.08,0.985,0.17,0.91 "
        "spacing 0.075,0.055\n",
        pictures::gnuplot_quoted(fmt::format("L(s) = G(s) A(s), eq. (15) and (6), slip per MPa: {} scenarios at slip {:.2f} and {:.0f} m/s",
                                             scenarios.size(), slip_reference, speed_mps)));
    const auto panel = [&](const char* title, const char* range, const char* y_range, const char* y_label, const char* columns, bool bottom,
                           bool titled) {
        fmt::format_to(std::back_inserter(script), "set title {}\nset xrange {}\nset yrange {}\nset ylabel {}\nset xlabel {}\n{}\n{}",
                       pictures::gnuplot_quoted(title), range, y_range, pictures::gnuplot_quoted(y_label),
                       pictures::gnuplot_quoted(bottom ? "frequency (rad/s)" : ""),
                       titled ? "set key at screen 0.5, 0.045 center maxrows 2 samplen 2 width 2 noenhanced" : "unset key",
                       plot(names, columns, titled));
    };
    panel("(a) overview", "[0.01:2000]", "[*:*]", "magnitude (dB)", "1:2", false, false);
    panel("(b) around the control loop's frequencies", "[10:400]", "[-60:0]", "magnitude (dB)", "1:2", false, false);
    panel("", "[0.01:2000]", "[-720:45]", "phase (deg)", "1:3", true, false);
    panel("", "[10:400]", "[-360:0]", "phase (deg)", "1:3", true, true);
    script += "unset multiplot\n";
    pictures::run_gnuplot(png, 1200, 800, script);
}

void draw_margins(const std::vector<StopConditions>& scenarios, const std::vector<Cell>& cells, const ReportHead& head,
                  const std::filesystem::path& png) {
    const Requirement& requirement = head.options.requirement;
    const std::vector<std::string> names = surfaces(scenarios);
    std::vector<std::string> bodies(names.size());
    std::size_t last = scenarios.size();
    for (const Cell& c : cells) {
        std::string& body = bodies[index_of(names, scenarios[c.scenario].surface)];
        if (c.scenario != last) body += "\n";
        last = c.scenario;
        const auto shown = [](double x) { return std::isfinite(x) ? fmt::format("{:.4f}", x) : "NaN"; };
        fmt::format_to(std::back_inserter(body), "{:.4f} {} {} {} {:.4f}\n", c.at.speed_mps, shown(c.law.full.phase_deg),
                       shown(c.law.full.gain_up_dB), shown(c.law.full.gain_down_dB), c.limits.phase_deg);
    }
    std::string script = blocks(bodies) + kStyle;
    script += fmt::format(
        "set multiplot layout 2,2 title {} noenhanced margins 0.07,0.985,0.17,0.91 spacing 0.075,0.1\n"
        "set xrange [0:*]\n",
        pictures::gnuplot_quoted(fmt::format("Margins of the shipped slip law over speed, tyre {}, all scenarios (one line each)", head.tyre)));
    const auto panel = [&](const char* title, const char* y_range, const char* columns, double wanted, bool bottom, bool titled) {
        fmt::format_to(std::back_inserter(script), "set title {}\nset yrange {}\nset xlabel {}\nunset arrow\n{}\n{}\n{}",
                       pictures::gnuplot_quoted(title), y_range, pictures::gnuplot_quoted(bottom ? "speed (m/s)" : ""),
                       wanted > 0.0 ? fmt::format("set arrow from graph 0, first {0} to graph 1, first {0} nohead dt 2 lc "
                                                  "rgb '#000000'",
                                                  wanted)
                                    : std::string(),
                       titled ? "set key at screen 0.5, 0.045 center maxrows 2 samplen 2 width 2 noenhanced" : "unset key",
                       plot(names, columns, titled));
    };
    panel("phase margin (deg), dashed: asked for", "[0:100]", "1:2", requirement.phase_deg, false, false);
    panel("largest phase margin of any controller (deg)", "[0:185]", "1:5", requirement.phase_deg, false, false);
    panel("upward gain margin (dB)", "[0:10]", "1:3", requirement.gain_dB, true, false);
    panel("downward gain margin (dB); no line: none needed", "[0:40]", "1:4", requirement.gain_dB, true, true);
    script += "unset multiplot\n";
    pictures::run_gnuplot(png, 1200, 850, script);
}

}  // namespace study::margins
