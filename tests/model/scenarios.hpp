/// The 32 scenarios: every surface with every maneuver of config/.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "rig_bridge/rig/load_rig.hpp"

struct NamedScenario {
    std::string name;
    plant::LoadedRig loaded;
};

inline std::vector<NamedScenario> all_scenarios() {
    std::vector<NamedScenario> all;
    for (const std::string& surface : plant::surface_names("config")) {
        for (const std::string& maneuver : plant::maneuver_names("config")) {
            plant::ManeuverChoice choice;
            choice.maneuver = maneuver;
            choice.surface = surface;
            std::string name = surface;
            name.append("/").append(maneuver);
            all.push_back({std::move(name), plant::load_rig("config", choice)});
        }
    }
    return all;
}
