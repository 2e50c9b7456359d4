/// Everything that was identified, as a table, as JSON, and as configuration files that the programs load.
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

/// One number as users see it.
struct Quantity {
    std::string name, unit;
    Estimate estimate;
};
[[nodiscard]] std::vector<Quantity> quantities(const Identified& found);

/// For people: name, estimate, 95 % interval.
[[nodiscard]] std::string to_table(const Identified& found);
/// `head`: keys of the caller's own, put first; a JSON object as text.
[[nodiscard]] std::string to_json(const Identified& found, const std::string& head);

/// What in a configuration directory the numbers belong to.
struct ConfigFiles {
    std::filesystem::path rig;         ///< landing_gear.toml or flywheel_rig.toml
    std::filesystem::path controller;  ///< controller.toml or another
};

/// Copies the directory `from` to `to`, which must not exist, with the identified numbers in place of the old ones: valve, wheel inertia, brake
/// and surfaces, in the plant's files and in the controller's. Every other byte stays. Throws settings::Error where a key is missing.
void write_config(const Identified& found, const ConfigFiles& files, const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace identification
