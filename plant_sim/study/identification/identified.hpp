/// All identified parameters, as a table, as JSON, and as configuration files that the programs load.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "plant_sim/study/identification/friction_fit.hpp"
#include "plant_sim/study/identification/valve_fit.hpp"
#include "plant_sim/study/identification/wheel_fit.hpp"

namespace identification {

struct Identified {
    ValveFit valve;
    std::optional<WheelFit> wheel;
    std::vector<FrictionFit> surfaces;
};

/// One parameter with name and unit for people.
struct Quantity {
    std::string name, unit;
    Estimate estimate;
};
[[nodiscard]] std::vector<Quantity> quantities(const Identified& found);

/// Text for people: name, estimate, 95 % interval.
[[nodiscard]] std::string to_table(const Identified& found);
/// `head`: a JSON object as text, whose keys come first.
[[nodiscard]] std::string to_json(const Identified& found, const std::string& head);

/// Files of a configuration directory in which the parameters are.
struct ConfigFiles {
    std::filesystem::path rig;         ///< landing_gear.toml or flywheel_rig.toml
    std::filesystem::path controller;  ///< controller.toml or another
};

/// Copies the directory `from` to `to`, which must not exist, and replaces the identified parameters in the files of plant and controller: valve,
/// wheel inertia, brake and surfaces. All other bytes are kept. Throws settings::Error if a key is missing.
void write_config(const Identified& found, const ConfigFiles& files, const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace identification
