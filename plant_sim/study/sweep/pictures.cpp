#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "plant_sim/study/sweep/summary.hpp"
#include "rig_bridge/pictures/figure.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

namespace sweep {

namespace {

using pictures::Chart;
using pictures::Series;
using pictures::Style;

std::string title_of(const Summary& s) {
    return fmt::format("{} landings for each slip reference, seed {}", s.identity.landings, s.identity.seed);
}

/// `y` over `x` of every reference with a few of them named, the paper's reference and the threshold law.
template <typename X, typename Y>
Chart chart(const Summary& s, const char* x_label, const char* y_label, pictures::Colour colour, const X& x, const Y& y) {
    Series means{.name = "slip references", .colour = colour};
    Series paper{.name = "reference 0.24", .style = Style::points, .colour = pictures::black};
    Series threshold{.name = "threshold law", .style = Style::points, .colour = pictures::orange};
    for (std::size_t i = 0; i < s.references.size(); ++i) {
        const Means& m = s.references[i];
        means.add(x(m), y(m));
        const bool named = i == 0 || i + 1 == s.references.size() || std::lround(m.slip_reference * 100.0) % 10 == 0;
        means.notes.push_back(named ? fmt::format("{:.2f}", m.slip_reference) : "");
        if (m.slip_reference == kPaperReference) paper.add(x(m), y(m));
    }
    if (s.threshold) threshold.add(x(*s.threshold), y(*s.threshold));
    return {.y_label = y_label, .x_label = x_label, .series = {std::move(means), std::move(paper), std::move(threshold)}};
}

constexpr auto kBrake_MJ = [](const Means& m) { return m.energy_brake_J * 1e-6; };
constexpr auto kTyre_MJ = [](const Means& m) { return m.energy_tyre_J * 1e-6; };
constexpr auto kJ_mu = [](const Means& m) { return m.j_mu; };
constexpr auto kDistance_m = [](const Means& m) { return m.stop_distance_m; };
constexpr const char* kBrakeLabel = "mean energy to the brake (MJ a stop)";
constexpr const char* kTyreLabel = "mean energy to the tyre (MJ a stop)";

}  // namespace

void draw_fig13(const Summary& s, const std::filesystem::path& png) {
    constexpr const char* kMeanJ_mu = "mean J_mu";
    constexpr const char* kMeanDistance = "mean braking distance (m)";
    pictures::draw({.title = title_of(s),
                    .charts = {chart(s, kBrakeLabel, kMeanJ_mu, pictures::blue, kBrake_MJ, kJ_mu),
                               chart(s, kBrakeLabel, kMeanDistance, pictures::vermillion, kBrake_MJ, kDistance_m),
                               chart(s, kTyreLabel, kMeanJ_mu, pictures::blue, kTyre_MJ, kJ_mu),
                               chart(s, kTyreLabel, kMeanDistance, pictures::vermillion, kTyre_MJ, kDistance_m)},
                    .columns = 2},
                   png);
}

void draw_fig14(const Summary& s, const std::filesystem::path& png) {
    Series brake{.name = "brake", .colour = pictures::blue};
    Series tyre{.name = "tyre", .colour = pictures::vermillion};
    for (const Means& m : s.references) {
        brake.add(m.slip_reference, kBrake_MJ(m));
        tyre.add(m.slip_reference, kTyre_MJ(m));
    }
    pictures::draw({.title = title_of(s),
                    .charts = {chart(s, kBrakeLabel, kTyreLabel, pictures::blue, kBrake_MJ, kTyre_MJ),
                               {.y_label = "mean energy (MJ a stop)", .x_label = "slip reference", .series = {std::move(brake), std::move(tyre)}}},
                    .columns = 2},
                   png);
}

}  // namespace sweep
