#include "plant_sim/study/validation/validation_picture.hpp"

#include <fmt/format.h>

#include "rig_bridge/pictures/gnuplot.hpp"

namespace validation {

void draw_validation(const std::filesystem::path& csv, const std::filesystem::path& png, const std::string& title) {
    pictures::run_gnuplot(png, 1100, 1000,
                          fmt::format(R"(set datafile separator ','
set datafile missing ''
data = {csv}
set style line 1 lc rgb '#202020' lw 2
set style line 2 lc rgb '#e07b39' lw 1.6 dt 2
set style line 3 lc rgb '#1f4e79' lw 2
set style line 4 lc rgb '#58a5d6' lw 1.6 dt 2
set key top right
set lmargin 11
set rmargin 3
stats data using 'time_s' nooutput
set xrange [0:STATS_max]
set multiplot layout 3,1 title {title} noenhanced
set ylabel 'speed (m/s)'
plot data using 'time_s':'speed_mps' with lines ls 1 title 'aircraft, recorded', \
     data using 'time_s':'simulated_speed_mps' with lines ls 2 title 'aircraft, simulated', \
     data using 'time_s':'wheel_rim_mps' with lines ls 3 title 'wheel, recorded', \
     data using 'time_s':'simulated_wheel_rim_mps' with lines ls 4 title 'wheel, simulated'
set ylabel 'slip'
plot data using 'time_s':'slip' with lines ls 3 title 'recorded', \
     data using 'time_s':'simulated_slip' with lines ls 4 title 'simulated'
set ylabel 'simulated - recorded (m/s)'
set xlabel 'time since brake-on (s)'
plot data using 'time_s':(column('simulated_speed_mps') - column('speed_mps')) with lines ls 1 title 'aircraft', \
     data using 'time_s':(column('simulated_wheel_rim_mps') - column('wheel_rim_mps')) with lines ls 4 title 'wheel'
unset multiplot
)",
                                      fmt::arg("csv", pictures::gnuplot_quoted(csv.string())), fmt::arg("title", pictures::gnuplot_quoted(title))));
}

}  // namespace validation
