/// Learnt variation of mu_b within a stop, as text, JSON, TOML and picture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plant_sim/lab/recorded_stops.hpp"
#include "plant_sim/wear/dynamics.hpp"

namespace plant_sim::lab {

struct ClassDynamics {
    ClassStops data;
    wear::FrictionDynamics found;
    wear::Curve in_force{};  ///< of the configuration, mean 1
};

struct DynamicsHead {
    std::string config_hash;
    std::string data_hash;  ///< hash of all samples
};

/// Numbers have two decimals more than their intervals.
[[nodiscard]] std::string to_text(const std::vector<ClassDynamics>& classes);
[[nodiscard]] std::string to_json(const std::vector<ClassDynamics>& classes, const DynamicsHead& head);
/// Table [brake.relative_friction], for `--friction-curves` and the rig's own file.
[[nodiscard]] std::string to_toml(const std::vector<ClassDynamics>& classes, const DynamicsHead& head);
/// Fig. 6: samples of the stops relative to each stop's mean, and the curve, over speed; one panel per class. Throws std::runtime_error if gnuplot is
/// missing or fails.
void draw_dynamics(const std::vector<ClassDynamics>& classes, const wear::DynamicsSettings& settings, const std::filesystem::path& png);

}  // namespace plant_sim::lab
