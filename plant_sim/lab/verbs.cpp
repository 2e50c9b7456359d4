#include "plant_sim/lab/verbs.hpp"

#include <fmt/core.h>

#include <array>
#include <cstdio>
#include <exception>
#include <memory>

#include "firmware/host/settings/atomic_file.hpp"
#include "rig_bridge/wear/on_threads.hpp"

namespace plant_sim::lab {

int run_parsed(std::span<const LabVerb> verbs) {
    for (const LabVerb& verb : verbs) {
        if (verb.app->parsed()) return verb.run();
    }
    return 2;
}

void write_json(const std::filesystem::path& file, const std::string& json_file, std::string_view text) {
    settings::write_file(file, text);
    settings::deliver(json_file, text);
    if (json_file == "-") fmt::print(stderr, "rig-lab: written to {}\n", file.parent_path().string());
}

LabVerb wear_verb(CLI::App& lab) {
    CLI::App* wear = lab.add_subcommand("wear", "What an endurance campaign says about the brake.");
    wear->require_subcommand(1);
    const std::array verbs{
        wear_table_verb(*wear),     //
        wear_dynamics_verb(*wear),  //
        wear_fit_verb(*wear),       //
        wear_simulate_verb(*wear),  //
        wear_population_verb(*wear), wear_forecast_verb(*wear), wear_watch_verb(*wear), wear_arena_verb(*wear),
    };
    return {wear, [verbs] { return run_parsed(verbs); }};
}

int in_team(const std::function<int(study::team::Team& team)>& work) {
    const std::unique_ptr<study::team::Team> team = study::team::join_team();
    try {
        return work(*team);
    } catch (const std::exception& e) {
        if (team->size() == 1) throw;
        // The others would wait for this one for ever.
        fmt::print(stderr, "rig-lab: process {}: {}\n", team->rank(), e.what());
        team->end_all(2);
        return 2;
    }
}

unsigned threads_in(const study::team::Team& team, unsigned asked) {
    if (asked > 0) return asked;
    // mpirun is told how many processes there shall be: one thread each, unless more are asked for.
    return team.size() > 1 ? 1 : wear::all_cores();
}

}  // namespace plant_sim::lab
