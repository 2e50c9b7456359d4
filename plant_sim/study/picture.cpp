#include "plant_sim/study/picture.hpp"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <stdexcept>

namespace study {

namespace {

std::string quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
    return out + "'";
}

std::string script(const std::filesystem::path& csv, const std::filesystem::path& png,
                   const std::string& title, double brake_on_s) {
    return fmt::format(R"(set terminal pngcairo size 1100,1000 font 'sans,11' enhanced
set output {png}
set datafile separator ','
data = {csv}
set style line 1 lc rgb '#1f4e79' lw 2
set style line 2 lc rgb '#c55a11' lw 1.6
set grid lc rgb '#dddddd'
set border lc rgb '#555555'
set key top center
set lmargin 10
set rmargin 3
set arrow 1 from {on}, graph 0 to {on}, graph 1 nohead dt 3 lc rgb '#555555'
set xrange [0:*]
set multiplot layout 3,1 title {title} noenhanced
set ylabel 'speed (m/s)'
plot data using 'time_s':'speed_mps' with lines ls 1 title 'aircraft', \
     data using 'time_s':'wheel_rim_speed_mps' with lines ls 2 title 'wheel'
set ylabel 'slip'
set yrange [-0.1:1.05]
plot data using 'time_s':($0 >= 0 && column('speed_mps') > 0.1 ? column('slip') : NaN) with lines ls 2 title 'slip', \
     data using 'time_s':(column('slip_reference') > 0 ? column('slip_reference') : NaN) with lines ls 1 title 'reference in force'
set ylabel 'brake pressure (MPa)'
set yrange [0:*]
set xlabel 'time (s)'
plot data using 'time_s':(column('pressure_demand_Pa') * 1e-6) with lines ls 1 title 'requested by the pilot', \
     data using 'time_s':(column('pressure_Pa') * 1e-6) with lines ls 2 title 'applied'
unset multiplot
)",
                       fmt::arg("png", quoted(png.string())), fmt::arg("csv", quoted(csv.string())),
                       fmt::arg("on", brake_on_s), fmt::arg("title", quoted(title)));
}

}  // namespace

void draw_stop(const std::filesystem::path& trajectory_csv, const std::filesystem::path& png,
               const std::string& title, double brake_on_s) {
    const std::filesystem::path aside = png.string() + ".part";
    const std::filesystem::path says = png.string() + ".gnuplot-says";
    std::FILE* gnuplot = ::popen(("gnuplot >" + quoted(says.string()) + " 2>&1").c_str(), "w");
    if (gnuplot == nullptr) throw std::runtime_error("cannot start gnuplot");
    const std::string commands = script(trajectory_csv, aside, title, brake_on_s);
    std::fwrite(commands.data(), 1, commands.size(), gnuplot);
    const int status = ::pclose(gnuplot);
    std::ifstream said(says);
    const std::string output((std::istreambuf_iterator<char>(said)), std::istreambuf_iterator<char>());
    std::error_code ignored;
    std::filesystem::remove(says, ignored);
    if (status != 0) {
        std::filesystem::remove(aside, ignored);
        throw std::runtime_error("gnuplot failed (is gnuplot-nox installed?): " + output);
    }
    std::filesystem::rename(aside, png);
}

}  // namespace study
