#include "plant_sim/lab/identify_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "rig_bridge/pictures/figure.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

namespace plant_sim::lab {

namespace {

namespace fs = std::filesystem;
using pictures::Series;

/// The table stays beside the picture.
std::string keep(const settings::TextTable& table, pictures::Figure figure, const fs::path& directory, const std::string& name) {
    settings::write_file(directory / (name + ".csv"), table.text());
    pictures::draw(std::move(figure), directory / (name + ".png"));
    return name + ".png";
}

Series dots(const char* name, pictures::Colour colour) {
    return {.name = name, .style = pictures::Style::points, .colour = colour};
}

/// Number of periods in a time, at least one.
std::size_t periods(const identification::ValveResiduals& r, double time_s) {
    return r.time_s.size() < 2 ? 1 : static_cast<std::size_t>(std::max(std::llround(time_s / (r.time_s[1] - r.time_s[0])), 1LL));
}

/// Whether the current has moved slowly and evenly for `settled` samples up to sample `k`. A sweep's staircase does for some of them, not for all.
bool ramps(const std::vector<double>& current_mA, std::size_t k, std::size_t settled) {
    constexpr double kMin_mA = 0.1;
    constexpr double kMax_mA = 2.0;
    constexpr double kEven_mA = 0.06;
    const double from = current_mA[k - settled];
    const double change = current_mA[k] - from;
    if (std::abs(change) < kMin_mA || std::abs(change) > kMax_mA) return false;
    for (std::size_t i = 0; i < settled; ++i) {
        const double even = from + change * static_cast<double>(i) / static_cast<double>(settled);
        if (std::abs(current_mA[k - settled + i] - even) > kEven_mA) return false;
    }
    return true;
}

/// Readings on ramps against current, and the fitted branches.
std::string draw_map(const identification::ValveFit& v, const fs::path& directory) {
    auto table = settings::TextTable::csv("current_mA:.4f|rising_MPa:.5f|falling_MPa:.5f|rising_error_kPa:.3f|falling_error_kPa:.3f|map_MPa:.5f");
    const std::optional<double> none;
    constexpr double kSettled_s = 0.3;  // of a slow ramp, after which the pressure is that of the map
    constexpr double kEvery_s = 0.025;
    Series rising = dots("measured, current rising", pictures::sky), falling = dots("measured, current falling", pictures::orange);
    Series rising_error = dots("current rising", pictures::sky), falling_error = dots("current falling", pictures::orange);
    Series line{.name = "identified map", .colour = pictures::blue};
    for (const auto& r : v.residuals) {
        const std::size_t settled = periods(r, kSettled_s), every = periods(r, kEvery_s);
        for (std::size_t k = settled; k < r.used.size(); k += every) {
            const double current_mA = r.current_mA[k];
            const double change = current_mA - r.current_mA[k - settled];
            if (r.used[k] == 0 || !ramps(r.current_mA, k, settled)) continue;
            const double reading_MPa = r.measured_Pa[k] * 1e-6;
            const double error_kPa = (r.measured_Pa[k] - r.modelled_Pa[k]) * 1e-3;
            (change > 0.0 ? rising : falling).add(current_mA, reading_MPa);
            (change > 0.0 ? rising_error : falling_error).add(current_mA, error_kPa);
            if (change > 0.0)
                table.add(current_mA, reading_MPa, none, error_kPa, none, none);
            else
                table.add(current_mA, none, reading_MPa, none, error_kPa, none);
        }
    }
    const rig::PressureMap map = v.map();
    for (const auto& point : map.points()) {
        line.add(point.current_mA, point.pressure_Pa * 1e-6);
        table.add(fmt::format("{:.5f}", point.current_mA), none, none, none, none, point.pressure_Pa * 1e-6);
    }
    return keep(table,
                {.title = fmt::format("static map: dead zone {:.3f} mA, hysteresis {:.2f} uA (95 %: {:.2f} to {:.2f})", v.dead_zone_mA.value,
                                      v.hysteresis_mA.value * 1e3, v.hysteresis_mA.low * 1e3, v.hysteresis_mA.high * 1e3),
                 .charts = {{.y_label = "pressure (MPa)",
                             .x_label = "valve current (mA)",
                             .series = {std::move(rising), std::move(falling), std::move(line)}},
                            {.y_label = "measured - modelled (kPa)",
                             .x_label = "valve current (mA)",
                             .series = {std::move(rising_error), std::move(falling_error)}}}},
                directory, "static_map");
}

std::string draw_valve(const identification::ValveResiduals& r, const fs::path& directory) {
    auto table = settings::TextTable::csv("time_s:.3f|current_mA:.3f|measured_MPa:.5f|modelled_MPa:.5f|error_kPa:.3f");
    // As many points as a picture has columns, several times over, show everything; steps need theirs.
    const std::size_t every = std::max<std::size_t>(1, r.time_s.size() / 12000);
    Series measured = dots("measured", pictures::sky), error = dots("", pictures::sky);
    Series modelled{.name = "modelled", .colour = pictures::vermillion};
    for (std::size_t k = 0; k < r.time_s.size(); k += every) {
        const auto error_kPa = r.used[k] != 0 ? std::optional((r.measured_Pa[k] - r.modelled_Pa[k]) * 1e-3) : std::nullopt;
        table.add(r.time_s[k], r.current_mA[k], r.measured_Pa[k] * 1e-6, r.modelled_Pa[k] * 1e-6, error_kPa);
        measured.add(r.time_s[k], r.measured_Pa[k] * 1e-6);
        modelled.add(r.time_s[k], r.modelled_Pa[k] * 1e-6);
        if (error_kPa) error.add(r.time_s[k], *error_kPa);
    }
    const char* const time = "time since brake-on (s)";
    return keep(table,
                {.title = fmt::format("{}: residuals of {:.1f} kPa RMS", r.recording, r.rms_Pa * 1e-3),
                 .charts = {{.y_label = "pressure (MPa)", .x_label = time, .series = {std::move(measured), std::move(modelled)}},
                            {.y_label = "measured - modelled (kPa)", .x_label = time, .series = {std::move(error)}}}},
                directory, "valve_" + r.recording);
}

std::string draw_wheel(const identification::WheelFit& w, const fs::path& directory) {
    auto table = settings::TextTable::csv("time_s:.3f|stop_mmps:.4f|touchdown_mmps:.4f");
    Series stops = dots("stops", pictures::blue), touchdowns = dots("touchdowns alone", pictures::orange);
    for (const auto& r : w.residuals) {
        for (std::size_t k = 0; k < r.time_s.size(); ++k) {
            const std::optional error_mmps = r.error_mps[k] * 1e3;
            table.add(r.time_s[k], r.braking ? error_mmps : std::nullopt, r.braking ? std::nullopt : error_mmps);
            (r.braking ? stops : touchdowns).add(r.time_s[k], *error_mmps);
        }
    }
    return keep(table,
                {.title = fmt::format("momentum of wheel and flywheel: J_w = {:.4f} kg m2, k_b = {:.5g} m3", w.inertia_kgm2.value, w.gain_m3.value),
                 .charts = {{.y_label = "measured - modelled rim speed (mm/s)",
                             .x_label = "time since brake-on (s)",
                             .series = {std::move(stops), std::move(touchdowns)}}}},
                directory, "wheel");
}

constexpr int kCurveParts = 400;

std::string draw_friction(const identification::FrictionFit& f, const fs::path& directory) {
    auto table = settings::TextTable::csv("slip:.6f|mu:.6f|error:.6f|deviation:.6f");
    Series measured = dots("load cells over encoders", pictures::sky), error = dots("", pictures::sky);
    Series fitted{.name = f.curve.magic ? "magic formula, identified" : "eq. (4), identified", .colour = pictures::vermillion};
    double last = 0.0;
    for (std::size_t k = 0; k < f.slip.size(); ++k) {
        const double difference = f.mu[k] - rig::friction(f.curve, f.slip[k]).mu;
        table.add(f.slip[k], f.mu[k], difference, f.deviation[k]);
        measured.add(f.slip[k], f.mu[k]);
        error.add(f.slip[k], difference / f.deviation[k]);
        last = std::max(last, f.slip[k]);
    }
    for (int i = 0; i <= kCurveParts; ++i) {
        const double slip = last * i / kCurveParts;
        fitted.add(slip, rig::friction(f.curve, slip).mu);
    }
    std::string title = f.surface;
    for (const auto& c : f.coefficients) title += fmt::format("{} {} = {:.5g}", &c == f.coefficients.data() ? ":" : ",", c.name, c.estimate.value);
    return keep(table,
                {.title = title,
                 .charts = {{.y_label = "friction F_x / F_z", .x_label = "slip", .series = {std::move(measured), std::move(fitted)}},
                            {.y_label = "(measured - fitted) / deviation", .x_label = "slip", .series = {std::move(error)}}}},
                directory, "friction_" + f.surface);
}

}  // namespace

std::vector<std::string> draw_identified(const identification::Identified& found, const fs::path& directory) {
    std::vector<std::string> names{draw_map(found.valve, directory)};
    for (const auto& r : found.valve.residuals) names.push_back(draw_valve(r, directory));
    if (found.wheel) names.push_back(draw_wheel(*found.wheel, directory));
    for (const auto& f : found.surfaces) names.push_back(draw_friction(f, directory));
    return names;
}

void draw_surfaces(const std::vector<rig::Surface>& surfaces, const std::vector<std::string>& strong, const std::filesystem::path& png) {
    pictures::Chart chart{.y_label = "friction coefficient", .x_label = "slip"};
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        const bool stands_out = std::find(strong.begin(), strong.end(), surfaces[i].name) != strong.end();
        Series one{.name = surfaces[i].name + (stands_out ? " (identified)" : ""), .colour = i, .width = stands_out ? 5.0 : 2.0};
        // Ice has its peak at a slip of 0.03: parts are fine there.
        for (int k = 0; k <= kCurveParts; ++k) {
            const double slip = std::pow(static_cast<double>(k) / kCurveParts, 2.0);
            one.add(slip, rig::friction(surfaces[i], slip).mu);
        }
        chart.series.push_back(std::move(one));
    }
    pictures::draw({.charts = {std::move(chart)}}, png);
}

}  // namespace plant_sim::lab
