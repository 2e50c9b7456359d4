#include "plant_sim/lab/surface_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "rig_bridge/pictures/gnuplot.hpp"

namespace plant_sim::lab {

void draw_surfaces(const std::vector<rig::Surface>& surfaces, const std::vector<std::string>& strong, const std::filesystem::path& png) {
    std::string script =
        "set key outside right top samplen 2 "
        "noenhanced\n"
        "set xlabel 'slip'\nset ylabel 'friction coefficient'\nset xrange [0:1]\nset yrange [0:*]\nset "
        "samples 1000\nplot ";
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
