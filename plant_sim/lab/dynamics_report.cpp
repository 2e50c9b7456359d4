#include "plant_sim/lab/dynamics_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "rig_bridge/pictures/figure.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

namespace plant_sim::lab {

namespace {

using settings::Json;

double at(const wear::Curve& curve, double x) {
    return curve[0] + x * (curve[1] + x * (curve[2] + x * curve[3]));
}

/// Of the learnt curve from the one in force, over the stop.
double greatest_difference(const ClassDynamics& c) {
    constexpr int kParts = 200;
    double greatest = 0.0;
    for (int i = 0; i <= kParts; ++i) {
        const double x = static_cast<double>(i) / kParts;
        greatest = std::max(greatest, std::abs(c.found.at(x) - at(c.in_force, x)));
    }
    return greatest;
}

std::string groups_of(const wear::FrictionDynamics& f) {
    return f.by_stops ? fmt::format("{} groups of whole stops left out in turn", f.groups)
                      : fmt::format("{} groups of bands of speed left out in turn: too few stops to leave out whole ones", f.groups);
}

Json json_of(const ClassDynamics& c) {
    const wear::FrictionDynamics& f = c.found;
    Json orders = Json::array();
    for (const wear::OrderLoss& o : f.orders) orders.push_back({{"order", o.order}, {"loss", o.loss}, {"standard_error_above_best", o.excess_error}});
    Json stops = Json::array();
    for (const wear::StopShape& s : f.stops)
        stops.push_back({{"source", s.source},
                         {"brake_on_mps", s.brake_on_mps},
                         {"mean_friction", s.mean_friction},
                         {"samples", s.samples},
                         {"rejected_share", s.rejected},
                         {"used", s.used}});
    return {{"class", c.data.friction_class},
            {"order", f.order},
            {"coefficients", f.curve},
            {"half_widths_95", f.half_width},
            {"covariance", f.covariance},
            {"t_quantile", f.quantile},
            {"scatter", f.scale},
            {"left_out", f.by_stops ? "stops" : "bands of speed"},
            {"groups", f.groups},
            {"in_force", c.in_force},
            {"greatest_difference_from_in_force", greatest_difference(c)},
            {"orders", orders},
            {"stops", stops}};
}

/// Samples, the curve with its band, and the one in force.
pictures::Chart chart(const ClassDynamics& c, const wear::DynamicsSettings& settings) {
    using pictures::Series;
    Series dots{.name = "recorded", .style = pictures::Style::points, .colour = pictures::grey};
    for (std::size_t i = 0; i < c.data.stops.size(); ++i) {
        for (const wear::FrictionSample& sample : wear::friction_samples(c.data.stops[i], settings))
            dots.add(sample.x, sample.mu_b / c.found.stops[i].mean_friction);
    }
    Series learnt{.name = fmt::format("learnt, order {}, with 95 % interval", c.found.order), .colour = pictures::vermillion, .width = 2.0};
    Series in_force{.name = "in force", .style = pictures::Style::dashes, .colour = pictures::blue};
    double least = 1.0;
    double greatest = 1.0;
    constexpr int kParts = 120;
    for (int i = 0; i <= kParts; ++i) {
        const double x = static_cast<double>(i) / kParts;
        const double f = c.found.at(x);
        const double half = c.found.half_width_at(x);
        least = std::min(least, f);
        greatest = std::max(greatest, f);
        learnt.add(x, f, f - half, f + half);
        in_force.add(x, at(c.in_force, x));
    }
    const double room = std::max(0.12 * (greatest - least), 6.0 * c.found.scale);
    return {.title = fmt::format("{}: {} stops", c.data.friction_class, c.data.stops.size()),
            .y_label = "friction / mean of the stop",
            .x_label = "speed / brake-on speed",
            .series = {std::move(dots), std::move(learnt), std::move(in_force)},
            .x_range = pictures::Range{0.0, 1.02},
            .y_range = pictures::Range{least - room, greatest + room}};
}

}  // namespace

std::string to_text(const std::vector<ClassDynamics>& classes) {
    auto table = settings::TextTable::screen("class:<8|stops:>6|samples:>9|order:>7|c0:>18|c1:>18|c2:>18|c3:>18");
    for (const ClassDynamics& c : classes) {
        const wear::FrictionDynamics& f = c.found;
        std::size_t samples = 0;
        for (const wear::StopShape& s : f.stops) samples += s.used ? s.samples : 0;
        const auto used = std::count_if(f.stops.begin(), f.stops.end(), [](const auto& s) { return s.used; });
        table.add(c.data.friction_class, used, samples, f.order);
        for (std::size_t k = 0; k < f.curve.size(); ++k) table.add(k <= f.order ? fmt::format("{:.4f} +- {:.4f}", f.curve[k], f.half_width[k]) : "-");
    }
    std::string out = table.text() + "\n";
    for (const ClassDynamics& c : classes) {
        const wear::FrictionDynamics& f = c.found;
        out += fmt::format("{}: scatter {:.3f} %, {}; loss by order", c.data.friction_class, f.scale * 100.0, groups_of(f));
        for (const wear::OrderLoss& o : f.orders) out += fmt::format("{} {:.4f}", o.order == 0 ? "" : ",", o.loss);
        out += fmt::format("; at most {:.4f} off the curve in force\n", greatest_difference(c));
        for (const wear::StopShape& s : f.stops) {
            constexpr double kNoteworthy = 0.1;
            if (!s.used)
                out += fmt::format("  {}: not used, {:.0f} % of its samples lie far off\n", s.source, s.rejected * 100.0);
            else if (s.rejected > kNoteworthy)
                out += fmt::format("  {}: {:.0f} % of its samples lie far off and have no say\n", s.source, s.rejected * 100.0);
        }
    }
    return out;
}

std::string to_json(const std::vector<ClassDynamics>& classes, const DynamicsHead& head) {
    Json list = Json::array();
    for (const ClassDynamics& c : classes) list.push_back(json_of(c));
    const Json json{{"study", "wear dynamics"},
                    {"version", ANTISKID_VERSION},
                    {"config_hash", head.config_hash},
                    {"data_hash", head.data_hash},
                    {"classes", list}};
    // A path need not be UTF-8; JSON must.
    return settings::json_page(json);
}

std::string to_toml(const std::vector<ClassDynamics>& classes, const DynamicsHead& head) {
    std::string out = fmt::format(
        "# mu_b over one stop relative to its mean, c0 + c1 x + c2 x^2 + c3 x^3 with x = v / v_brake_on, as rig-lab wear dynamics\n"
        "# learnt it (version {}, configuration {}, data {}).\n\n[brake.relative_friction]\n",
        ANTISKID_VERSION, head.config_hash, head.data_hash);
    for (const ClassDynamics& c : classes) {
        const wear::FrictionDynamics& f = c.found;
        out += fmt::format("# {} stops, order {}, 95 %: +- [{:.4f}]\n", f.stops.size(), f.order, fmt::join(f.half_width, ", "));
        // TOML's numbers have a point: 0.0, not 0.
        out += fmt::format("{} = [{:.6f}]\n", c.data.friction_class, fmt::join(f.curve, ", "));
    }
    return out;
}

void draw_dynamics(const std::vector<ClassDynamics>& classes, const wear::DynamicsSettings& settings, const std::filesystem::path& png) {
    pictures::Figure figure;
    for (const ClassDynamics& c : classes) figure.charts.push_back(chart(c, settings));
    pictures::draw(std::move(figure), png);
}

}  // namespace plant_sim::lab
