#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <memory>

#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/lab/identify_pictures.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "rig_bridge/rig/load_rig.hpp"

namespace plant_sim::lab {

namespace {

struct SurfacesCommand {
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path out = "out/surfaces";
    std::string json_file;  ///< "-": standard output
    bool pictures = true;

    int run() const {
        std::vector<rig::Surface> surfaces;
        rig::ManeuverChoice choice;
        for (const std::string& name : rig::surface_names(config)) {
            choice.surface = name;
            surfaces.push_back(rig::load_rig(config, choice).rig.surface);
        }
        settings::Json rows = settings::Json::array();
        auto table = settings::TextTable::screen("surface:<18|curve:<36|peak_slip:>12.3f|peak_mu:>10.3f|mu_locked:>14.3f");
        for (const rig::Surface& s : surfaces) {
            const rig::Peak peak = rig::peak(s);
            const double locked = rig::friction(s, 1.0).mu;
            const rig::MagicFormula m = s.magic.value_or(rig::MagicFormula{});
            table.add(s.name,
                      s.magic ? fmt::format("B {:g}, C {:g}, D {:g}, E {:g}", m.B, m.C, m.D, m.E)
                              : fmt::format("c1 {:g}, c2 {:g}, c3 {:g}", s.c1, s.c2, s.c3),
                      peak.slip, peak.mu, locked);
            settings::Json row = s.magic ? settings::Json{{"magic_formula", {{"B", m.B}, {"C", m.C}, {"D", m.D}, {"E", m.E}}}}
                                         : settings::Json{{"c1", s.c1}, {"c2", s.c2}, {"c3", s.c3}};
            row.update({{"surface", s.name}, {"peak_slip", peak.slip}, {"peak_mu", peak.mu}, {"locked_mu", locked}});
            rows.push_back(std::move(row));
        }
        const std::array<std::filesystem::path, 1> files{config / "surfaces.toml"};
        const settings::Json json{{"study", "surfaces"}, {"version", ANTISKID_VERSION}, {"config_hash", settings::hash(files)}, {"surfaces", rows}};
        write_json(out / "results.json", json_file, settings::json_page(json));
        if (pictures) draw_surfaces(surfaces, {}, out / "surfaces.png");
        print_table(json_file, "{}Written to {}: results.json{}\n", table.text(), out.string(), pictures ? " surfaces.png" : "");
        return 0;
    }
};

}  // namespace

LabVerb surfaces_verb(CLI::App& lab) {
    const auto command = std::make_shared<SurfacesCommand>();
    CLI::App* verb = lab.add_subcommand("surfaces", "Fig. 3: friction over slip of every surface, and its peak.");
    settings::add_config_directory(*verb, command->config);
    settings::add_json(*verb, command->json_file, "results");
    settings::add_out(*verb, command->out, "directory of results.json and surfaces.png");
    settings::add_no_pictures(*verb, command->pictures);
    verb->footer("Example:\n  rig-lab surfaces --out out/surfaces");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim::lab
