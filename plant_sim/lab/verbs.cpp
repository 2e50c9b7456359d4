#include "plant_sim/lab/verbs.hpp"

#include <array>

#include "firmware/host/settings/atomic_file.hpp"

namespace plant_sim {

int run_parsed(std::span<const LabVerb> verbs) {
    for (const LabVerb& verb : verbs) {
        if (verb.app->parsed()) return verb.run();
    }
    return 2;
}

void keep_json(const std::filesystem::path& file, const std::string& json_file, std::string_view text) {
    settings::write_file(file, text);
    settings::deliver(json_file, text);
}

LabVerb wear_verb(CLI::App& lab) {
    CLI::App* wear = lab.add_subcommand("wear", "What an endurance campaign says about the brake.");
    wear->require_subcommand(1);
    const std::array verbs{
        wear_table_verb(*wear),     //
        wear_dynamics_verb(*wear),  //
        wear_fit_verb(*wear),       //
        wear_simulate_verb(*wear),  //
        wear_population_verb(*wear), wear_forecast_verb(*wear), wear_watch_verb(*wear),
    };
    return {wear, [verbs] { return run_parsed(verbs); }};
}

}  // namespace plant_sim
