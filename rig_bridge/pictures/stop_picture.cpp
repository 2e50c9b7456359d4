#include "rig_bridge/pictures/stop_picture.hpp"

#include <fmt/format.h>

#include "rig_bridge/pictures/gnuplot.hpp"

namespace pictures {

namespace {

constexpr const char* kRunway = R"(unset arrow 1
set xrange [0:*]
set yrange [0:*]
set xlabel 'on the runway, from touchdown (m)'
set ylabel 'friction'
plot $data using 'runway_m':($0 >= 0 && column('F_z_N') > 0 ? column('mu_max') : NaN) with lines ls 1 title 'available at this speed', \
     $data using 'runway_m':($0 >= 0 && column('F_z_N') > 0 ? column('mu') : NaN) with lines ls 2 title 'used'
)";

std::string script(std::string_view csv, const std::string& title, double brake_on_s, bool along_runway) {
    return fmt::format(R"(set datafile separator ','
{csv}set style line 1 lc rgb '#1f4e79' lw 2
set style line 2 lc rgb '#c55a11' lw 1.6
set key top center
set lmargin 10
set rmargin 3
set arrow 1 from {on}, graph 0 to {on}, graph 1 nohead dt 3 lc rgb '#555555'
set xrange [0:*]
set multiplot layout {rows},1 title {title} noenhanced
set ylabel 'speed (m/s)'
plot $data using 'time_s':'speed_mps' with lines ls 1 title 'aircraft', \
     $data using 'time_s':'wheel_rim_speed_mps' with lines ls 2 title 'wheel'
set ylabel 'slip'
set yrange [-0.1:1.05]
plot $data using 'time_s':($0 >= 0 && column('speed_mps') > 0.1 ? column('slip') : NaN) with lines ls 2 title 'slip', \
     $data using 'time_s':(column('slip_reference') > 0 ? column('slip_reference') : NaN) with lines ls 1 title 'reference in force'
set ylabel 'brake pressure (MPa)'
set yrange [0:*]
set xlabel 'time (s)'
plot $data using 'time_s':(column('pressure_demand_Pa') * 1e-6) with lines ls 1 title 'requested by the pilot', \
     $data using 'time_s':(column('pressure_Pa') * 1e-6) with lines ls 2 title 'applied'
{runway}unset multiplot
)",
                       fmt::arg("csv", gnuplot_block("data", csv)), fmt::arg("on", brake_on_s), fmt::arg("title", gnuplot_quoted(title)),
                       fmt::arg("rows", along_runway ? 4 : 3), fmt::arg("runway", along_runway ? kRunway : ""));
}

}  // namespace

void draw_stop(std::string_view csv, const std::filesystem::path& png, const std::string& title, double brake_on_s, bool along_runway) {
    run_gnuplot(png, 1100, along_runway ? 1300 : 1000, script(csv, title, brake_on_s, along_runway));
}

}  // namespace pictures
