#include "plant_sim/lab/dynamics_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "firmware/host/settings/text_table.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

namespace plant_sim::lab {

namespace {

using Json = nlohmann::ordered_json;

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

/// A panel's data blocks: samples, and the curve with its band and the one in force.
std::string blocks(const ClassDynamics& c, std::size_t panel, const wear::DynamicsSettings& settings) {
    std::string dots, curve;
    constexpr std::size_t kMaxDots = 4000;
    std::size_t all = 0;
    for (const wear::StopShape& s : c.found.stops) all += s.samples;
    const std::size_t every = all / kMaxDots + 1;
    for (std::size_t i = 0; i < c.data.stops.size(); ++i) {
        const wear::RecordedStop& stop = c.data.stops[i];
        const wear::StopShape& shape = c.found.stops[i];
        const std::vector<wear::FrictionSample> samples = wear::friction_samples(stop, settings);
        for (std::size_t k = i % every; k < samples.size(); k += every)
            fmt::format_to(std::back_inserter(dots), "{:.4f} {:.6f}\n", samples[k].x, samples[k].mu_b / shape.mean_friction);
    }
    constexpr int kParts = 120;
    for (int i = 0; i <= kParts; ++i) {
        const double x = static_cast<double>(i) / kParts;
        const double f = c.found.at(x);
        const double half = c.found.half_width_at(x);
        fmt::format_to(std::back_inserter(curve), "{:.4f} {:.6f} {:.6f} {:.6f} {:.6f}\n", x, f, f - half, f + half, at(c.in_force, x));
    }
    return pictures::gnuplot_block(fmt::format("samples{}", panel), dots) + pictures::gnuplot_block(fmt::format("curve{}", panel), curve);
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
        fmt::format_to(std::back_inserter(out), "{}: scatter {:.3f} %, {}; loss by order", c.data.friction_class, f.scale * 100.0, groups_of(f));
        for (const wear::OrderLoss& o : f.orders) fmt::format_to(std::back_inserter(out), "{} {:.4f}", o.order == 0 ? "" : ",", o.loss);
        fmt::format_to(std::back_inserter(out), "; at most {:.4f} off the curve in force\n", greatest_difference(c));
        for (const wear::StopShape& s : f.stops) {
            constexpr double kNoteworthy = 0.1;
            if (!s.used)
                fmt::format_to(std::back_inserter(out), "  {}: not used, {:.0f} % of its samples lie far off\n", s.source, s.rejected * 100.0);
            else if (s.rejected > kNoteworthy)
                fmt::format_to(std::back_inserter(out), "  {}: {:.0f} % of its samples lie far off and have no say\n", s.source, s.rejected * 100.0);
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
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_toml(const std::vector<ClassDynamics>& classes, const DynamicsHead& head) {
    std::string out = fmt::format(
        "# mu_b over one stop relative to its mean, c0 + c1 x + c2 x^2 + c3 x^3 with x = v / v_brake_on, as rig-lab wear dynamics\n"
        "# learnt it (version {}, configuration {}, data {}).\n\n[brake.relative_friction]\n",
        ANTISKID_VERSION, head.config_hash, head.data_hash);
    for (const ClassDynamics& c : classes) {
        const wear::FrictionDynamics& f = c.found;
        fmt::format_to(std::back_inserter(out), "# {} stops, order {}, 95 %: +- [{:.4f}]\n", f.stops.size(), f.order, fmt::join(f.half_width, ", "));
        // TOML's numbers have a point: 0.0, not 0.
        fmt::format_to(std::back_inserter(out), "{} = [{:.6f}]\n", c.data.friction_class, fmt::join(f.curve, ", "));
    }
    return out;
}

void draw_dynamics(const std::vector<ClassDynamics>& classes, const wear::DynamicsSettings& settings, const std::filesystem::path& png) {
    constexpr int kPanel = 330;
    std::string script =
        "set key top right samplen 2\nset lmargin 10\nset rmargin 3\n"
        "set xrange [0:1.02]\nset ylabel 'friction / mean of the stop'\n";
    for (std::size_t i = 0; i < classes.size(); ++i) script += blocks(classes[i], i, settings);
    fmt::format_to(std::back_inserter(script), "set multiplot layout {},1\n", classes.size());
    for (std::size_t i = 0; i < classes.size(); ++i) {
        const ClassDynamics& c = classes[i];
        double min = 1.0;
        double greatest = 1.0;
        constexpr int kParts = 50;
        for (int k = 0; k <= kParts; ++k) {
            const double f = c.found.at(static_cast<double>(k) / kParts);
            min = std::min(min, f);
            greatest = std::max(greatest, f);
        }
        const double room = std::max(0.12 * (greatest - min), 6.0 * c.found.scale);
        fmt::format_to(std::back_inserter(script),
                       "set title {} noenhanced\nset xlabel '{}'\nset yrange [{}:{}]\n"
                       "plot $samples{panel} using 1:2 with dots lc rgb '#7a7a7a' notitle, \\\n"
                       "     NaN with points pt 7 ps 0.4 lc rgb '#7a7a7a' title 'recorded', \\\n"
                       "     $curve{panel} using 1:3:4 with filledcurves fs solid 0.35 noborder lc rgb '#c55a11' title '95 % interval', \\\n"
                       "     $curve{panel} using 1:2 with lines lw 2 lc rgb '#c55a11' title 'learnt, order {order}', \\\n"
                       "     $curve{panel} using 1:5 with lines lw 1.5 dt 2 lc rgb '#1f4e79' title 'in force'\n",
                       pictures::gnuplot_quoted(fmt::format("{}: {} stops", c.data.friction_class, c.data.stops.size())),
                       i + 1 == classes.size() ? "speed / brake-on speed" : "", min - room, greatest + room, fmt::arg("panel", i),
                       fmt::arg("order", c.found.order));
    }
    script += "unset multiplot\n";
    pictures::run_gnuplot(png, 1000, 60 + kPanel * static_cast<int>(classes.size()), script);
}

}  // namespace plant_sim::lab
