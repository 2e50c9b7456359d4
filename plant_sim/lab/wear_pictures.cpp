#include "plant_sim/lab/wear_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "rig_bridge/pictures/figure.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"
#include "rig_bridge/pictures/map.hpp"

namespace plant_sim::lab {

namespace {

using pictures::Chart;
using pictures::Series;
using pictures::Style;

Series dots(const char* name, std::size_t colour) {
    return {.name = name, .style = Style::points, .colour = colour};
}

Series dots(const wear::Campaign& campaign, const char* name, pictures::Colour colour) {
    Series all = dots(name, colour);
    for (const wear::Point& p : campaign.points) all.add(p.c_e_J * 1e-6, p.mean_friction);
    return all;
}

/// The points of each component that is their most likely one.
std::vector<Series> members_of(const wear::Campaign& campaign, const wear::Model& model) {
    std::vector<Series> members;
    for (std::size_t j = 0; j < model.mixture.components().size(); ++j) members.push_back(dots("", j));
    for (const wear::Point& p : campaign.points) members[model.mixture.member(p)].add(p.c_e_J * 1e-6, p.mean_friction);
    return members;
}

Chart campaign_chart(std::vector<Series> series) {
    return {.y_label = "mean brake friction", .x_label = "cumulative brake energy (MJ)", .series = std::move(series)};
}

/// The upper and the lower half of x = mean + 2 L [cos, sin], each in order of x.
std::array<Series, 2> ellipse(const wear::Component& c, std::size_t colour) {
    constexpr int kSteps = 60;
    const double l11 = std::sqrt(c.variance_c_e_J2);
    const double l21 = c.covariance_J / l11;
    const double l22 = std::sqrt(c.variance_friction - l21 * l21);
    Series upper{.name = "two-sigma ellipse of a component", .colour = colour, .in_legend = colour == 0};
    Series lower = upper;
    lower.in_legend = false;
    for (int i = 0; i <= kSteps; ++i) {
        const double angle = std::numbers::pi * i / kSteps;
        const double u = 2.0 * std::cos(angle);
        const double v = 2.0 * std::sin(angle);
        upper.add((c.mean_c_e_J + l11 * u) * 1e-6, c.mean_friction + l21 * u + l22 * v);
        lower.add((c.mean_c_e_J + l11 * u) * 1e-6, c.mean_friction + l21 * u - l22 * v);
    }
    return {upper, lower};
}

struct Frame {
    double c_min_MJ, c_greatest_MJ, mu_min, mu_greatest;
};

Frame frame_of(const wear::Model::Data& d) {
    const double c = 0.03 * (d.last_c_e_J - d.first_c_e_J) * 1e-6;
    const double mu = 0.12 * (d.greatest_friction - d.min_friction);
    return {d.first_c_e_J * 1e-6 - c, d.last_c_e_J * 1e-6 + c, d.min_friction - mu, d.greatest_friction + mu};
}

std::string landings_text(const wear::Forecast& f) {
    const auto text = [](const std::optional<int>& landings) { return landings ? fmt::format("{}", *landings) : std::string("beyond the horizon"); };
    if (f.already_crossed()) return "below the limit already";
    return fmt::format("landings left (dotted): {} (10 %), {} (50 %), {} (90 %)", text(f.landings_left[0]), text(f.landings_left[1]),
                       text(f.landings_left[2]));
}

}  // namespace

void draw_campaign(const wear::Campaign& campaign, const wear::Model& model, const std::filesystem::path& png) {
    constexpr int kSteps = 400;
    const std::vector<wear::Component>& components = model.mixture.components();
    std::vector<Series> all = members_of(campaign, model);
    for (std::size_t j = 0; j < components.size(); ++j)
        for (Series& half : ellipse(components[j], j)) all.push_back(std::move(half));
    Series mean{.name = "mean given the energy", .colour = pictures::black, .width = 2.0};
    for (int i = 0; i <= kSteps; ++i) {
        const double a_J = model.data.first_c_e_J + (model.data.last_c_e_J - model.data.first_c_e_J) * i / kSteps;
        mean.add(a_J * 1e-6, wear::friction_given_energy(model, a_J, {wear::Variance::exact, wear::Choice::mixture}).mean());
    }
    all.push_back(std::move(mean));
    Chart chart = campaign_chart(std::move(all));
    const Frame f = frame_of(model.data);
    chart.x_range = pictures::Range{f.c_min_MJ, f.c_greatest_MJ};
    chart.y_range = pictures::Range{f.mu_min, f.mu_greatest};
    pictures::draw({.title = fmt::format("{} maneuvers, {} components", model.data.maneuvers, components.size()), .charts = {std::move(chart)}}, png);
}

void draw_density(const wear::Campaign& campaign, const wear::Model& model, const std::filesystem::path& png) {
    constexpr int kGridColumns = 120;
    constexpr int kGridRows = 90;
    const Frame f = frame_of(model.data);
    pictures::Map map{
        .title = fmt::format("density of {} components, and the points by their most likely component", model.mixture.components().size()),
        .x_label = "cumulative brake energy (MJ)",
        .y_label = "mean brake friction",
        .columns = kGridColumns + 1,
        .x = {f.c_min_MJ, f.c_greatest_MJ},
        .y = {f.mu_min, f.mu_greatest},
        .value_label = "log10 of the density (per MJ)",
        .contour_step = 0.5};
    auto table = settings::TextTable::csv("cumulative_energy_MJ:.5g|mean_friction:.6g|log10_density_per_MJ:.4g");
    for (int row = 0; row <= kGridRows; ++row) {
        for (int column = 0; column <= kGridColumns; ++column) {
            const double c_MJ = f.c_min_MJ + (f.c_greatest_MJ - f.c_min_MJ) * column / kGridColumns;
            const double mu = f.mu_min + (f.mu_greatest - f.mu_min) * row / kGridRows;
            map.values.push_back(std::log10(1e6) + model.mixture.log_density({c_MJ * 1e6, mu}) / std::log(10.0));
            table.add(c_MJ, mu, map.values.back());
        }
    }
    settings::write_file(std::filesystem::path(png).replace_extension(".csv"), table.text());
    constexpr double kDecades = 4.0;
    const double greatest = *std::max_element(map.values.begin(), map.values.end());
    map.value_range = {greatest - kDecades, greatest};
    map.points = members_of(campaign, model);
    pictures::draw(map, 700, png);
}

void draw_resimulation(const wear::Campaign& recorded, const wear::Campaign& simulated, const std::filesystem::path& png) {
    pictures::draw({.charts = {campaign_chart({dots(recorded, "recorded", pictures::blue), dots(simulated, "simulated", pictures::vermillion)})}},
                   png);
}

void draw_orders(const wear::Model& model, const std::filesystem::path& png) {
    Series bic{.name = "BIC", .colour = pictures::blue}, score{.name = "score", .colour = pictures::blue};
    Series bic_chosen{.name = fmt::format("chosen: {}", model.mixture.components().size()), .style = Style::points, .colour = pictures::vermillion};
    Series score_chosen = bic_chosen;
    for (const wear::Model::Candidate& o : model.orders) {
        const auto m = static_cast<double>(o.components);
        const bool chosen = o.components == model.mixture.components().size();
        bic.add(m, o.bic);
        if (chosen) bic_chosen.add(m, o.bic);
        if (o.score) score.add(m, *o.score);
        if (chosen && o.score) score_chosen.add(m, *o.score);
    }
    Chart least{.y_label = "BIC (less is better)", .x_label = "components", .series = {std::move(bic), std::move(bic_chosen)}};
    Chart greatest{.y_label = "log score of blocks left out", .x_label = "components", .series = {std::move(score), std::move(score_chosen)}};
    pictures::Figure figure{.charts = {std::move(least)}, .columns = 2};
    if (!greatest.series.front().x.empty()) figure.charts.push_back(std::move(greatest));
    pictures::draw(std::move(figure), png);
}

void draw_forecast(const wear::Campaign& recorded, const wear::Forecast& f, double limit, const std::filesystem::path& png) {
    Series fan{.name = "friction by the brake filter: 50 %, with 10 to 90 %", .colour = pictures::blue, .width = 2.0};
    for (const wear::FanPoint& p : f.fan) fan.add(p.c_e_J * 1e-6, p.friction[1], p.friction[0], p.friction[2]);
    const double last_MJ = f.fan.empty() ? f.c_e_J * 1e-6 : f.fan.back().c_e_J * 1e-6;
    Chart chart = campaign_chart({std::move(fan), dots(recorded, "recorded", pictures::grey),
                                  pictures::level(fmt::format("limit {:.4f}", limit), 0.0, last_MJ, limit, pictures::vermillion)});
    for (const std::optional<double>& at_J : f.crossing_J)
        if (at_J && !f.already_crossed()) chart.marks.push_back(*at_J * 1e-6);
    pictures::draw({.title = landings_text(f), .charts = {std::move(chart)}}, png);
}

void draw_health(const wear::Campaign& recorded, const std::vector<wear::Verdict>& verdicts, const std::filesystem::path& png) {
    const auto last = static_cast<double>(verdicts.size());
    Series expected{.name = "expected, two deviations", .colour = pictures::sky};
    Series well = dots("recorded", pictures::blue), suspect = dots("suspect", pictures::orange), abnormal = dots("abnormal", pictures::vermillion);
    Series statistic{.name = "statistic", .colour = pictures::blue};
    for (std::size_t i = 0; i < verdicts.size(); ++i) {
        const wear::Verdict& v = verdicts[i];
        const auto at = static_cast<double>(i + 1);
        expected.add(at, v.expected, v.expected - 2.0 * v.deviation, v.expected + 2.0 * v.deviation);
        statistic.add(at, v.statistic);
        Series& one = v.condition == wear::Condition::abnormal ? abnormal : v.condition == wear::Condition::suspect ? suspect : well;
        one.add(at, recorded.points[i].mean_friction);
    }
    const auto flagged =
        std::find_if(verdicts.begin(), verdicts.end(), [](const wear::Verdict& v) { return v.condition == wear::Condition::abnormal; });
    const auto number = flagged - verdicts.begin() + 1;
    const bool sound = flagged == verdicts.end();
    const std::vector<double> marks = sound ? std::vector<double>{} : std::vector{static_cast<double>(number)};
    pictures::draw({.title = sound ? fmt::format("{} maneuvers, not abnormal", verdicts.size())
                                   : fmt::format("abnormal at maneuver {}: {}", number, flagged->reason),
                    .charts = {{.y_label = "mean brake friction",
                                .x_label = "maneuver",
                                .series = {std::move(expected), std::move(well), std::move(suspect), std::move(abnormal)},
                                .marks = marks},
                               {.y_label = "statistic (share of its limit)",
                                .x_label = "maneuver",
                                .series = {std::move(statistic), pictures::level("abnormal", 0.0, last, 1.0, pictures::vermillion),
                                           pictures::level("suspect", 0.0, last, wear::HealthMonitor::kSuspectFrom, pictures::orange)},
                                .marks = marks}}},
                   png);
}

}  // namespace plant_sim::lab
