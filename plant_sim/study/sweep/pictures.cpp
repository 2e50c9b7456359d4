#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "plant_sim/study/sweep/summary.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

namespace sweep {

namespace {

constexpr const char* kStyle = R"(set style line 1 lc rgb '#1f4e79' lw 2 pt 7 ps 0.6
set style line 2 lc rgb '#c55a11' lw 2 pt 5 ps 0.6
)";

std::string point(const Means& m) {
    return fmt::format("{:.4f} {:.6f} {:.6f} {:.7f} {:.4f}\n", m.slip_reference, m.energy_brake_J * 1e-6, m.energy_tyre_J * 1e-6, m.j_mu,
                       m.stop_distance_m);
}

/// Blocks $means, $labels (a few references), $paper (0.24) and $threshold: reference, brake MJ, tyre MJ, J_mu, distance.
std::string data(const Summary& s) {
    std::string means, labels, paper;
    for (std::size_t i = 0; i < s.references.size(); ++i) {
        const Means& m = s.references[i];
        means += point(m);
        const bool end = i == 0 || i + 1 == s.references.size();
        if (end || std::lround(m.slip_reference * 100.0) % 10 == 0) labels += point(m);
        if (m.slip_reference == kPaperReference) paper += point(m);
    }
    return pictures::gnuplot_block("means", means) + pictures::gnuplot_block("labels", labels) + pictures::gnuplot_block("paper", paper) +
           pictures::gnuplot_block("threshold", s.threshold ? point(*s.threshold) : "");
}

/// One panel of Fig. 13: `column` is that of the energy, `label_y` where labels of the references stand.
std::string panel(int column, const std::string& what) {
    return fmt::format(R"(set xlabel 'mean energy to the {what} (MJ a stop)'
set ylabel 'mean J_{{/Symbol m}}' tc rgb '#1f4e79'
set y2label 'mean braking distance (m)' tc rgb '#c55a11'
set ytics nomirror
set y2tics
plot $means using {x}:4 with linespoints ls 1 title 'J_{{/Symbol m}}', \
     $means using {x}:5 axes x1y2 with linespoints ls 2 title 'distance', \
     $labels using {x}:4:(sprintf('%.2f', $1)) with labels offset 0,1.1 tc rgb '#1f4e79' font ',9' notitle, \
     $paper using {x}:4 with points pt 6 ps 2.2 lw 2 lc rgb 'black' title 'reference 0.24', \
     $paper using {x}:5 axes x1y2 with points pt 6 ps 2.2 lw 2 lc rgb 'black' notitle, \
     $threshold using {x}:4 with points pt 2 ps 1.6 lw 2 lc rgb '#1f4e79' title 'threshold law: J_{{/Symbol m}}', \
     $threshold using {x}:5 axes x1y2 with points pt 2 ps 1.6 lw 2 lc rgb '#c55a11' title 'threshold law: distance'
)",
                       fmt::arg("what", what), fmt::arg("x", column));
}

std::string title_of(const Summary& s) {
    return pictures::gnuplot_quoted(fmt::format("{} landings for each slip reference, seed {}", s.identity.landings, s.identity.seed));
}

}  // namespace

void draw_fig13(const Summary& s, const std::filesystem::path& png) {
    const std::string script = kStyle + data(s) +
                               "set key outside top center horizontal\nset tmargin 5\nset offsets graph 0.02, graph 0.02, graph 0.08, graph 0.02\n"
                               "set multiplot layout 2,1\nset title " +
                               title_of(s) + "\n" +
                               // Brake energy falls as the reference rises: the axis is turned so that the reference rises to the right in both.
                               "set label 1 'slip reference rises {/Symbol \\256}' at graph 0.55, graph 0.5 center tc rgb '#555555'\n"
                               "set xrange [*:*] reverse\n" +
                               panel(2, "brake") + "unset title\nset xrange [*:*] noreverse\n" + panel(3, "tyre") + "unset multiplot\n";
    pictures::run_gnuplot(png, 1000, 1100, script);
}

void draw_fig14(const Summary& s, const std::filesystem::path& png) {
    const std::string script = kStyle + data(s) + "set multiplot layout 1,2 title " + title_of(s) + "\n" +
                               R"(set key top right
set offsets graph 0.08, 0, 0, graph 0.03
set xlabel 'mean energy to the brake (MJ a stop)'
set ylabel 'mean energy to the tyre (MJ a stop)'
plot $means using 2:3 with linespoints ls 1 title 'slip references', \
     $labels using 2:3:(sprintf('%.2f', $1)) with labels right offset -0.8,-0.6 tc rgb '#1f4e79' font ',9' notitle, \
     $paper using 2:3 with points pt 6 ps 2.2 lw 2 lc rgb 'black' title 'reference 0.24', \
     $threshold using 2:3 with points pt 2 ps 1.6 lw 2 lc rgb '#c55a11' title 'threshold law'
unset offsets
set key center right
set xlabel 'slip reference'
set ylabel 'mean energy (MJ a stop)'
set yrange [0:*]
plot $means using 1:2 with linespoints ls 1 title 'brake', \
     $means using 1:3 with linespoints ls 2 title 'tyre'
unset multiplot
)";
    pictures::run_gnuplot(png, 1300, 620, script);
}

}  // namespace sweep
