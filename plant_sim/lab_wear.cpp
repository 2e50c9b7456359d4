#include "plant_sim/lab_wear.hpp"

#include <array>

namespace plant_sim {

LabVerb wear_verb(CLI::App& lab) {
    CLI::App* wear = lab.add_subcommand("wear", "What an endurance campaign says about the brake.");
    wear->require_subcommand(1);
    const std::array verbs{wear_table_verb(*wear), wear_fit_verb(*wear), wear_simulate_verb(*wear)};
    return {wear, [verbs] {
                for (const LabVerb& verb : verbs) {
                    if (verb.app->parsed()) return verb.run();
                }
                return 2;
            }};
}

}  // namespace plant_sim
