/// The 32 scenarios: every surface with every maneuver of config/.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "rig_bridge/rig/load_rig.hpp"

struct NamedScenario {
    std::string name;
    rig::LoadedRig loaded;
};

inline std::vector<NamedScenario> all_scenarios() {
    std::vector<NamedScenario> all;
    for (const std::string& surface : rig::surface_names("config")) {
        for (const std::string& maneuver : rig::maneuver_names("config")) {
            rig::ManeuverChoice choice;
            choice.maneuver = maneuver;
            choice.surface = surface;
            std::string name = surface;
            name.append("/").append(maneuver);
            all.push_back({std::move(name), rig::load_rig("config", choice)});
        }
    }
    return all;
}
