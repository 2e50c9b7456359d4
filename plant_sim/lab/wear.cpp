#include "plant_sim/lab/wear.hpp"

#include <array>

namespace plant_sim::lab {

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

}  // namespace plant_sim::lab
