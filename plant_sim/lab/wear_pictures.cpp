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

/// Blocks $points0, $points1, ...: the points by their most likely component.
std::string members(const wear::Campaign& campaign, const wear::Mixture& mixture) {
    std::vector<std::string> blocks(mixture.components().size());
    for (const wear::Point& p : campaign.points)
        fmt::format_to(std::back_inserter(blocks[mixture.member(p)]), "{:.6f} {:.7f}\n", p.c_e_J * 1e-6, p.mean_friction);
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

}  // namespace

void draw_campaign(const wear::Campaign& campaign, const wear::Model& model, const std::filesystem::path& png) {
    constexpr int kSteps = 400;
    const std::vector<wear::Component>& components = model.mixture.components();
    std::string script = kCampaignStyle + members(campaign, model.mixture) + ranges(frame_of(model.data)) + "$mean << EOD\n";
    for (int i = 0; i <= kSteps; ++i) {
        const double a_J = model.data.first_c_e_J + (model.data.last_c_e_J - model.data.first_c_e_J) * i / kSteps;
        const wear::Conditional c = wear::friction_given_energy(model, a_J, {wear::Variance::exact, wear::Choice::mixture});
        fmt::format_to(std::back_inserter(script), "{:.6f} {:.7f}\n", a_J * 1e-6, c.mean());
    }
    script += "EOD\n";
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
    std::string script = kCampaignStyle + members(campaign, model.mixture) + ranges(f) + "$density << EOD\n";
    double greatest = -1e300;
    for (int row = 0; row <= kGridRows; ++row) {
        for (int column = 0; column <= kGridColumns; ++column) {
            const double c_MJ = f.c_min_MJ + (f.c_greatest_MJ - f.c_min_MJ) * column / kGridColumns;
            const double mu = f.mu_min + (f.mu_greatest - f.mu_min) * row / kGridRows;
            const double density = std::log10(1e6) + model.mixture.log_density({c_MJ * 1e6, mu}) / std::log(10.0);
            greatest = std::max(greatest, density);
            fmt::format_to(std::back_inserter(script), "{:.5f} {:.7f} {:.4f}\n", c_MJ, mu, density);
        }
        script += "\n";
    }
    constexpr double kDecades = 4.0;
    fmt::format_to(std::back_inserter(script), R"(EOD
set contour base
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
    const auto block = [](const char* name, const wear::Campaign& campaign) {
        std::string out;
        for (const wear::Point& p : campaign.points) fmt::format_to(std::back_inserter(out), "{:.6f} {:.7f}\n", p.c_e_J * 1e-6, p.mean_friction);
        return pictures::gnuplot_block(name, out);
    };
    pictures::run_gnuplot(png, 1100, 700,
                          kCampaignStyle + block("recorded", recorded) + block("simulated", simulated) +
                              "plot $recorded with points pt 7 ps 0.6 lc rgb '#1f4e79' title 'recorded', \\\n"
                              "     $simulated with points pt 1 ps 0.8 lc rgb '#c55a11' title 'simulated'\n");
}

void draw_bic(const wear::Model& model, const std::filesystem::path& png) {
    std::string script =
        "set xtics 1\nset offsets 0.5, 0.5, graph "
        "0.05, graph 0.05\n"
        "set xlabel 'components'\nset ylabel 'BIC (less is better)'\n$bic << EOD\n";
    const auto min = std::min_element(model.orders.begin(), model.orders.end(),
                                      [](const wear::Model::Candidate& a, const wear::Model::Candidate& b) { return a.bic < b.bic; });
    for (const wear::Model::Candidate& o : model.orders) fmt::format_to(std::back_inserter(script), "{} {:.6f}\n", o.components, o.bic);
    fmt::format_to(std::back_inserter(script),
                   "EOD\n$least << EOD\n{} {:.6f}\nEOD\n"
                   "plot $bic with linespoints pt 7 ps 0.8 lw 1.5 lc rgb '#1f4e79' notitle, \\\n"
                   "     $least with points pt 6 ps 2.5 lw 2 lc rgb '#c55a11' title 'chosen: {}'\n",
                   min->components, min->bic, min->components);
    pictures::run_gnuplot(png, 900, 600, script);
}

}  // namespace plant_sim::lab
