#include "plant_sim/lab/identify_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

namespace plant_sim::lab {

namespace {

namespace fs = std::filesystem;
using pictures::gnuplot_quoted;

constexpr const char* kStyle = R"(set datafile separator ','
set datafile missing ''
set style line 1 lc rgb '#1f4e79' lw 2
set style line 2 lc rgb '#e07b39' lw 2
set style line 3 lc rgb '#9ab8d6' pt 7 ps 0.3
set style line 4 lc rgb '#e9b48f' pt 7 ps 0.3
set lmargin 11
set rmargin 3
)";

/// `rows` panels of the table, which stays beside the picture.
void draw(const settings::TextTable& table, const fs::path& png, int height, const std::string& title, const std::string& plots, int rows) {
    settings::write_file(fs::path(png).replace_extension(".csv"), table.text());
    pictures::run_gnuplot(png, 1100, height,
                          fmt::format("{}{}set multiplot layout {},1 title {} noenhanced\n{}unset multiplot\n", kStyle,
                                      pictures::gnuplot_block("data", table.text()), rows, gnuplot_quoted(title), plots));
}

constexpr std::size_t kSettled = 300;  // samples of a slow ramp after which the pressure is that of the map

/// Whether the current has moved slowly and evenly up to sample `k`. A sweep's staircase does for some samples, not for all of kSettled.
bool ramps(const std::vector<double>& current_mA, std::size_t k) {
    constexpr double kMin_mA = 0.1;
    constexpr double kMax_mA = 2.0;
    constexpr double kEven_mA = 0.06;
    const double from = current_mA[k - kSettled];
    const double change = current_mA[k] - from;
    if (std::abs(change) < kMin_mA || std::abs(change) > kMax_mA) return false;
    for (std::size_t i = 0; i < kSettled; ++i) {
        const double even = from + change * static_cast<double>(i) / static_cast<double>(kSettled);
        if (std::abs(current_mA[k - kSettled + i] - even) > kEven_mA) return false;
    }
    return true;
}

/// Readings on ramps against current, and the fitted branches.
std::string draw_map(const identification::ValveFit& v, const fs::path& directory) {
    auto table = settings::TextTable::csv("current_mA:.4f|rising_MPa:.5f|falling_MPa:.5f|rising_error_kPa:.3f|falling_error_kPa:.3f|map_MPa:.5f");
    const std::optional<double> none;
    constexpr std::size_t kEvery = 25;
    for (const auto& r : v.residuals) {
        for (std::size_t k = kSettled; k < r.used.size(); k += kEvery) {
            const double change = r.current_mA[k] - r.current_mA[k - kSettled];
            if (r.used[k] == 0 || !ramps(r.current_mA, k)) continue;
            const double reading_MPa = r.measured_Pa[k] * 1e-6;
            const double error_kPa = (r.measured_Pa[k] - r.modelled_Pa[k]) * 1e-3;
            if (change > 0.0)
                table.add(r.current_mA[k], reading_MPa, none, error_kPa, none, none);
            else
                table.add(r.current_mA[k], none, reading_MPa, none, error_kPa, none);
        }
    }
    const rig::PressureMap map = v.map();
    for (const auto& point : map.points()) table.add(fmt::format("{:.5f}", point.current_mA), none, none, none, none, point.pressure_Pa * 1e-6);
    draw(table, directory / "static_map.png", 900,
         fmt::format("static map: dead zone {:.3f} mA, hysteresis {:.2f} uA (95 %: {:.2f} to {:.2f})", v.dead_zone_mA.value,
                     v.hysteresis_mA.value * 1e3, v.hysteresis_mA.low * 1e3, v.hysteresis_mA.high * 1e3),
         R"(set key top left
set xrange [0:*]
set ylabel 'pressure (MPa)'
plot $data using 'current_mA':'rising_MPa' with points ls 3 notitle, \
     $data using 'current_mA':'falling_MPa' with points ls 4 notitle, \
     keyentry with points ls 3 ps 1 title 'measured, current rising', \
     keyentry with points ls 4 ps 1 title 'measured, current falling', \
     $data using 'current_mA':'map_MPa' with linespoints ls 1 pt 6 ps 1 title 'identified map'
set xlabel 'valve current (mA)'
set ylabel 'measured - modelled (kPa)'
plot $data using 'current_mA':'rising_error_kPa' with points ls 3 notitle, \
     $data using 'current_mA':'falling_error_kPa' with points ls 4 notitle
)",
         2);
    return "static_map.png";
}

std::string draw_valve(const identification::ValveResiduals& r, const fs::path& directory) {
    std::string name = "valve_" + r.recording + ".png";
    auto table = settings::TextTable::csv("time_s:.3f|current_mA:.3f|measured_MPa:.5f|modelled_MPa:.5f|error_kPa:.3f");
    // As many points as the picture has columns twice over show everything; steps need theirs.
    const std::size_t every = std::max<std::size_t>(1, r.time_s.size() / 12000);
    for (std::size_t k = 0; k < r.time_s.size(); k += every) {
        const auto error_kPa = r.used[k] != 0 ? std::optional((r.measured_Pa[k] - r.modelled_Pa[k]) * 1e-3) : std::nullopt;
        table.add(r.time_s[k], r.current_mA[k], r.measured_Pa[k] * 1e-6, r.modelled_Pa[k] * 1e-6, error_kPa);
    }
    draw(table, directory / name, 900, fmt::format("{}: residuals of {:.1f} kPa RMS", r.recording, r.rms_Pa * 1e-3),
         R"(set key top right
stats $data using 'time_s' nooutput
set xrange [0:STATS_max]
set offsets graph 0, graph 0, graph 0.15, graph 0
set ylabel 'pressure (MPa)'
plot $data using 'time_s':'measured_MPa' with points ls 3 notitle, keyentry with points ls 3 ps 1 title 'measured', \
     $data using 'time_s':'modelled_MPa' with lines ls 2 title 'modelled'
unset offsets
set xlabel 'time since brake-on (s)'
set ylabel 'measured - modelled (kPa)'
plot $data using 'time_s':'error_kPa' with points ls 3 notitle
)",
         2);
    return name;
}

std::string draw_wheel(const identification::WheelFit& w, const fs::path& directory) {
    auto table = settings::TextTable::csv("time_s:.3f|stop_mmps:.4f|touchdown_mmps:.4f");
    for (const auto& r : w.residuals) {
        for (std::size_t k = 0; k < r.time_s.size(); ++k) {
            const std::optional error_mmps = r.error_mps[k] * 1e3;
            table.add(r.time_s[k], r.braking ? error_mmps : std::nullopt, r.braking ? std::nullopt : error_mmps);
        }
    }
    draw(table, directory / "wheel.png", 560,
         fmt::format("momentum of wheel and flywheel: J_w = {:.4f} kg m2, k_b = {:.5g} m3", w.inertia_kgm2.value, w.gain_m3.value),
         R"(set key top right
set xlabel 'time since brake-on (s)'
set ylabel 'measured - modelled rim speed (mm/s)'
plot $data using 'time_s':'stop_mmps' with points ls 3 notitle, keyentry with points ls 3 ps 1 title 'stops', \
     $data using 'time_s':'touchdown_mmps' with points ls 4 notitle, keyentry with points ls 4 ps 1 title 'touchdowns alone'
)",
         1);
    return "wheel.png";
}

std::string draw_friction(const identification::FrictionFit& f, const fs::path& directory) {
    std::string name = "friction_" + f.surface + ".png";
    auto table = settings::TextTable::csv("slip:.6f|mu:.6f|error:.6f|deviation:.6f");
    const rig::Surface curve = f.curve();
    for (std::size_t k = 0; k < f.slip.size(); ++k) table.add(f.slip[k], f.mu[k], f.mu[k] - rig::friction(curve, f.slip[k]).mu, f.deviation[k]);
    const std::string plots = fmt::format(R"(c1 = {}
c2 = {}
c3 = {}
mu(x) = c1 * (1 - exp(-c2 * x)) - c3 * x
set key bottom right
stats $data using 'slip' nooutput
set xrange [0:STATS_max * 1.05]
set samples 500
set ylabel 'friction F_x / F_z'
plot $data using 'slip':'mu' with points ls 3 notitle, keyentry with points ls 3 ps 1 title 'load cells over encoders', \
     mu(x) with lines ls 2 title 'eq. (4), identified'
set xlabel 'slip'
set ylabel '(measured - fitted) / expected deviation'
plot $data using 'slip':(column('error') / column('deviation')) with points ls 3 notitle
)",
                                          f.c1.value, f.c2.value, f.c3.value);
    draw(table, directory / name, 900, fmt::format("{}: c1 = {:.4f}, c2 = {:.3f}, c3 = {:.4f}", f.surface, f.c1.value, f.c2.value, f.c3.value), plots,
         2);
    return name;
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
    std::string script =
        "set key outside right top samplen 2 noenhanced\n"
        "set xlabel 'slip'\nset ylabel 'friction coefficient'\nset xrange [0:1]\nset yrange [0:*]\nset samples 1000\nplot ";
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        const rig::Surface& s = surfaces[i];
        const bool stands_out = std::find(strong.begin(), strong.end(), s.name) != strong.end();
        fmt::format_to(std::back_inserter(script), "{}{} * (1 - exp(-{} * x)) - {} * x with lines lw {} lc rgb '{}' title {}",
                       i == 0 ? "" : ", \\\n     ", s.c1, s.c2, s.c3, stands_out ? 5 : 2, pictures::gnuplot_colour(i),
                       pictures::gnuplot_quoted(s.name + (stands_out ? " (identified)" : "")));
    }
    pictures::run_gnuplot(png, 1000, 560, script + "\n");
}

}  // namespace plant_sim::lab
