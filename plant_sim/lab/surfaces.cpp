#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>

#include "config/reader/hash.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/model/load_rig.hpp"
#include "plant_sim/study/gnuplot.hpp"

namespace plant_sim {

namespace {

constexpr std::array<const char*, 8> kColours{"#1f4e79", "#c55a11", "#548235", "#7f3f98",
                                              "#bf9000", "#00808a", "#a61c3c", "#5b5b5b"};

void draw(const std::vector<plant::Surface>& surfaces, const std::filesystem::path& png) {
    std::string script =
        "set grid lc rgb '#dddddd'\nset border lc rgb '#555555'\nset key outside right top samplen 2 "
        "noenhanced\n"
        "set xlabel 'slip'\nset ylabel 'friction coefficient'\nset xrange [0:1]\nset yrange [0:*]\nset "
        "samples 1000\nplot ";
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        const plant::Surface& s = surfaces[i];
        fmt::format_to(std::back_inserter(script),
                       "{}{} * (1 - exp(-{} * x)) - {} * x with lines lw 2 lc rgb '{}' title {}",
                       i == 0 ? "" : ", \\\n     ", s.c1, s.c2, s.c3, kColours[i % kColours.size()],
                       study::gnuplot_quoted(s.name));
    }
    study::run_gnuplot(png, 1000, 560, script + "\n");
}

struct SurfacesCommand {
    std::filesystem::path config = "config";
    std::filesystem::path out = "out/surfaces";
    bool pictures = true;

    int run() const {
        std::vector<plant::Surface> surfaces;
        plant::ManeuverChoice choice;
        for (const std::string& name : plant::surface_names(config)) {
            choice.surface = name;
            surfaces.push_back(plant::load_rig(config, choice).rig.surface);
        }
        nlohmann::ordered_json rows = nlohmann::ordered_json::array();
        fmt::print("{:<18}{:>9}{:>10}{:>9}{:>12}{:>10}{:>14}\n", "surface", "c1", "c2", "c3", "peak_slip",
                   "peak_mu", "mu_locked");
        for (const plant::Surface& s : surfaces) {
            const plant::Peak peak = plant::peak(s);
            const double locked = plant::friction(s, 1.0).mu;
            fmt::print("{:<18}{:>9.4f}{:>10.3f}{:>9.4f}{:>12.3f}{:>10.3f}{:>14.3f}\n", s.name, s.c1, s.c2,
                       s.c3, peak.slip, peak.mu, locked);
            rows.push_back({{"surface", s.name},
                            {"c1", s.c1},
                            {"c2", s.c2},
                            {"c3", s.c3},
                            {"peak_slip", peak.slip},
                            {"peak_mu", peak.mu},
                            {"locked_mu", locked}});
        }
        const std::array<std::filesystem::path, 1> files{config / "surfaces.toml"};
        const nlohmann::ordered_json json{{"study", "surfaces"},
                                          {"version", ANTISKID_VERSION},
                                          {"config_hash", settings::hash(files)},
                                          {"surfaces", rows}};
        deliver((out / "results.json").string(), json.dump(2) + "\n");
        if (pictures) draw(surfaces, out / "surfaces.png");
        return 0;
    }
};

}  // namespace

LabVerb surfaces_verb(CLI::App& lab) {
    const auto command = std::make_shared<SurfacesCommand>();
    CLI::App* verb =
        lab.add_subcommand("surfaces", "Fig. 3: friction over slip of every surface, eq. (4), and its peak.");
    verb->add_option("--config", command->config, "directory of the configuration files")
        ->capture_default_str();
    verb->add_option("--out", command->out, "directory of results.json and surfaces.png")
        ->capture_default_str();
    verb->add_flag("!--no-pictures", command->pictures, "without gnuplot");
    verb->footer("Example:\n  rig-lab surfaces --out out/surfaces");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim
