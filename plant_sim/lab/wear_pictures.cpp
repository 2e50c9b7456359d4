#include "plant_sim/lab/wear_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string>

#include "rig_bridge/pictures/gnuplot.hpp"

namespace plant_sim::lab {

namespace {

constexpr const char* kCampaignStyle = R"(set xlabel 'cumulative brake energy (MJ)'
set ylabel 'mean brake friction'
)";

std::string line_of(const wear::Point& p) {
    return fmt::format("{:.6f} {:.7f}\n", p.c_e_J * 1e-6, p.mean_friction);
}

std::string lines_of(const wear::Campaign& campaign) {
    std::string out;
    for (const wear::Point& p : campaign.points) out += line_of(p);
    return out;
}

/// Blocks $points0, $points1, ...: the points by their most likely component.
std::string members(const wear::Campaign& campaign, const wear::Mixture& mixture) {
    std::vector<std::string> blocks(mixture.components().size());
    for (const wear::Point& p : campaign.points) blocks[mixture.member(p)] += line_of(p);
    std::string out;
    for (std::size_t j = 0; j < blocks.size(); ++j) out += pictures::gnuplot_block(fmt::format("points{}", j), blocks[j]);
    return out;
}

std::string member_plots(std::size_t components) {
    std::string out;
    for (std::size_t j = 0; j < components; ++j)
        fmt::format_to(std::back_inserter(out), ", $points{} using 1:2 with points pt 7 ps 0.5 lc rgb '{}' notitle", j, pictures::gnuplot_colour(j));
    return out;
}

/// x = mean + 2 L [cos, sin].
std::string ellipse(const wear::Component& c) {
    constexpr int kSteps = 72;
    const double l11 = std::sqrt(c.variance_c_e_J2);
    const double l21 = c.covariance_J / l11;
    const double l22 = std::sqrt(c.variance_friction - l21 * l21);
    std::string out;
    for (int i = 0; i <= kSteps; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / kSteps;
        const double u = 2.0 * std::cos(angle);
        const double v = 2.0 * std::sin(angle);
        fmt::format_to(std::back_inserter(out), "{:.6f} {:.7f}\n", (c.mean_c_e_J + l11 * u) * 1e-6, c.mean_friction + l21 * u + l22 * v);
    }
    return out;
}

struct Frame {
    double c_min_MJ, c_greatest_MJ, mu_min, mu_greatest;
};

Frame frame_of(const wear::Model::Data& d) {
    const double c = 0.03 * (d.last_c_e_J - d.first_c_e_J) * 1e-6;
    const double mu = 0.12 * (d.greatest_friction - d.min_friction);
    return {d.first_c_e_J * 1e-6 - c, d.last_c_e_J * 1e-6 + c, d.min_friction - mu, d.greatest_friction + mu};
}

std::string ranges(const Frame& f) {
    return fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\n", f.c_min_MJ, f.c_greatest_MJ, f.mu_min, f.mu_greatest);
}

constexpr const char* kStyleOfForecasts = "set lmargin 11\nset rmargin 4\n";

std::string landings_text(const wear::Forecast& f) {
    const auto text = [](const std::optional<int>& landings) { return landings ? fmt::format("{}", *landings) : std::string("beyond the horizon"); };
    if (f.already_crossed()) return "below the limit already";
    return fmt::format("landings left: {} (10 %), {} (50 %), {} (90 %)", text(f.landings_left[0]), text(f.landings_left[1]),
                       text(f.landings_left[2]));
}

}  // namespace

void draw_campaign(const wear::Campaign& campaign, const wear::Model& model, const std::filesystem::path& png) {
    constexpr int kSteps = 400;
    const std::vector<wear::Component>& components = model.mixture.components();
    std::string mean;
    for (int i = 0; i <= kSteps; ++i) {
        const double a_J = model.data.first_c_e_J + (model.data.last_c_e_J - model.data.first_c_e_J) * i / kSteps;
        const wear::Conditional c = wear::friction_given_energy(model, a_J, {wear::Variance::exact, wear::Choice::mixture});
        mean += line_of({a_J, c.mean()});
    }
    std::string script = kCampaignStyle + members(campaign, model.mixture) + ranges(frame_of(model.data)) + pictures::gnuplot_block("mean", mean);
    for (std::size_t j = 0; j < components.size(); ++j) script += pictures::gnuplot_block(fmt::format("ellipse{}", j), ellipse(components[j]));
    fmt::format_to(std::back_inserter(script), "set title {} noenhanced\nplot NaN notitle{}",
                   pictures::gnuplot_quoted(fmt::format("{} maneuvers, {} components", model.data.maneuvers, components.size())),
                   member_plots(components.size()));
    for (std::size_t j = 0; j < components.size(); ++j)
        fmt::format_to(std::back_inserter(script), ", $ellipse{} with lines lw 1.5 lc rgb '{}' title '{}'", j, pictures::gnuplot_colour(j),
                       j == 0 ? "two-sigma ellipse of a component" : "");
    script += ", $mean with lines lw 2 lc rgb 'black' title 'mean given the energy'\n";
    pictures::run_gnuplot(png, 1100, 700, script);
}

void draw_density(const wear::Campaign& campaign, const wear::Model& model, const std::filesystem::path& png) {
    constexpr int kGridColumns = 240;
    constexpr int kGridRows = 180;
    const Frame f = frame_of(model.data);
    std::string grid;
    double greatest = -1e300;
    for (int row = 0; row <= kGridRows; ++row) {
        for (int column = 0; column <= kGridColumns; ++column) {
            const double c_MJ = f.c_min_MJ + (f.c_greatest_MJ - f.c_min_MJ) * column / kGridColumns;
            const double mu = f.mu_min + (f.mu_greatest - f.mu_min) * row / kGridRows;
            const double density = std::log10(1e6) + model.mixture.log_density({c_MJ * 1e6, mu}) / std::log(10.0);
            greatest = std::max(greatest, density);
            fmt::format_to(std::back_inserter(grid), "{:.5f} {:.7f} {:.4f}\n", c_MJ, mu, density);
        }
        grid += "\n";
    }
    std::string script = kCampaignStyle + members(campaign, model.mixture) + ranges(f) + pictures::gnuplot_block("density", grid);
    constexpr double kDecades = 4.0;
    fmt::format_to(std::back_inserter(script), R"(set contour base
set cntrparam levels incremental {least},0.5,{greatest}
unset surface
set table $contours
splot $density
unset table
set palette defined (0 '#ffffff', 0.4 '#c9dcee', 1 '#7fa8cf')
set cbrange [{least}:{greatest}]
set cblabel 'log_{{10}} density (per MJ)'
set title {title} noenhanced
plot $density using 1:2:3 with image notitle, $contours using 1:2 with lines lw 1 lc rgb '#444444' notitle{points}
)",
                   fmt::arg("least", greatest - kDecades), fmt::arg("greatest", greatest),
                   fmt::arg("title", pictures::gnuplot_quoted(fmt::format("density of {} components, and the points by their most likely component",
                                                                          model.mixture.components().size()))),
                   fmt::arg("points", member_plots(model.mixture.components().size())));
    pictures::run_gnuplot(png, 1100, 700, script);
}

void draw_resimulation(const wear::Campaign& recorded, const wear::Campaign& simulated, const std::filesystem::path& png) {
    pictures::run_gnuplot(png, 1100, 700,
                          kCampaignStyle + pictures::gnuplot_block("recorded", lines_of(recorded)) +
                              pictures::gnuplot_block("simulated", lines_of(simulated)) +
                              "plot $recorded with points pt 7 ps 0.6 lc rgb '#1f4e79' title 'recorded', \\\n"
                              "     $simulated with points pt 1 ps 0.8 lc rgb '#c55a11' title 'simulated'\n");
}

void draw_bic(const wear::Model& model, const std::filesystem::path& png) {
    const auto min = std::min_element(model.orders.begin(), model.orders.end(),
                                      [](const wear::Model::Candidate& a, const wear::Model::Candidate& b) { return a.bic < b.bic; });
    const auto line = [](const wear::Model::Candidate& o) { return fmt::format("{} {:.6f}\n", o.components, o.bic); };
    std::string all;
    for (const wear::Model::Candidate& o : model.orders) all += line(o);
    const std::string script =
        "set xtics 1\nset offsets 0.5, 0.5, graph 0.05, graph 0.05\nset xlabel 'components'\nset ylabel 'BIC (less is better)'\n" +
        pictures::gnuplot_block("bic", all) + pictures::gnuplot_block("least", line(*min)) +
        fmt::format(
            "plot $bic with linespoints pt 7 ps 0.8 lw 1.5 lc rgb '#1f4e79' notitle, \\\n"
            "     $least with points pt 6 ps 2.5 lw 2 lc rgb '#c55a11' title 'chosen: {}'\n",
            min->components);
    pictures::run_gnuplot(png, 900, 600, script);
}

void draw_forecast(const wear::Campaign& recorded, const wear::Forecast& f, double limit, const std::filesystem::path& png) {
    std::string script = kStyleOfForecasts;
    script += kCampaignStyle + pictures::gnuplot_block("points", lines_of(recorded));
    double min = limit;
    double max = limit;
    for (const wear::Point& p : recorded.points) {
        min = std::min(min, p.mean_friction);
        max = std::max(max, p.mean_friction);
    }
    std::string fan;
    for (const wear::FanPoint& p : f.fan)
        fmt::format_to(std::back_inserter(fan), "{:.6f} {:.7f} {:.7f} {:.7f}\n", p.c_e_J * 1e-6, p.friction[0], p.friction[1], p.friction[2]);
    const double last_MJ = f.fan.empty() ? f.c_e_J * 1e-6 : f.fan.back().c_e_J * 1e-6;
    const double room = max - min;
    script +=
        pictures::gnuplot_block("fan", fan) + fmt::format("set xrange [0:{}]\nset yrange [{}:{}]\n", last_MJ, min - 0.45 * room, max + 0.08 * room);
    int arrow = 1;
    for (std::size_t q = 0; q < f.crossing_J.size(); ++q) {
        const std::optional<double> at_J = f.crossing_J.at(q);
        if (!at_J || f.already_crossed()) continue;
        fmt::format_to(std::back_inserter(script), "set arrow {} from {}, graph 0 to {}, first {} nohead dt {} lw 1.5 lc rgb '#a61c3c'\n", arrow++,
                       *at_J * 1e-6, *at_J * 1e-6, limit, q == 1 ? 1 : 2);
    }
    script += fmt::format(
        "set title {} noenhanced\nset key top right\n"
        "plot $fan using 1:2:4 with filledcurves lc rgb '#c9dcee' title '10 to 90 % of the mean friction', \\\n"
        "     $fan using 1:3 with lines lw 2 lc rgb '#1f4e79' title '50 %', \\\n"
        "     $points using 1:2 with points pt 7 ps 0.5 lc rgb '#555555' title 'recorded', \\\n"
        "     {} with lines lw 2 lc rgb '#a61c3c' title 'limit {:.4f}'\n",
        pictures::gnuplot_quoted(landings_text(f)), limit, limit);
    pictures::run_gnuplot(png, 1100, 700, script);
}

void draw_health(const wear::Campaign& recorded, const std::vector<wear::Verdict>& verdicts, const std::filesystem::path& png) {
    std::string health;
    double max = 1.2;
    for (std::size_t i = 0; i < verdicts.size(); ++i) {
        const wear::Verdict& v = verdicts[i];
        max = std::max(max, v.statistic * 1.1);
        fmt::format_to(std::back_inserter(health), "{} {:.7f} {:.7f} {:.7f} {:.5f} {}\n", i + 1, recorded.points[i].mean_friction,
                       v.expected - 2.0 * v.deviation, v.expected + 2.0 * v.deviation, v.statistic, static_cast<int>(v.condition));
    }
    const auto flagged =
        std::find_if(verdicts.begin(), verdicts.end(), [](const wear::Verdict& v) { return v.condition == wear::Condition::abnormal; });
    std::string script = kStyleOfForecasts + pictures::gnuplot_block("health", health);
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
