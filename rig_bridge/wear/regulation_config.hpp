/// Configuration of wear regulation, config/regulation.toml: plan, rules, floor table of references per surface, assumed scatter of lives, and
/// prices.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rig_bridge/wear/floor.hpp"
#include "rig_bridge/wear/regulator.hpp"

namespace wear {

/// Relative standard deviations of lives about the plan's, and of readings about the truth.
struct Deviations {
    double brake = 0.0;
    double tyre = 0.0;
    double inspection = 0.0;  ///< of the worn share read at an inspection, of a whole new part
};

/// The owner's prices, in any currency.
struct Prices {
    double brake = 0.0;  ///< from new to worn out
    double tyre = 0.0;
    double visit = 0.0;  ///< per workshop visit, whatever is changed
    double metre = 0.0;  ///< of stopping distance, each landing
};

struct RegulationConfig {
    /// Without `brake_life_J`, `landing_J` and `landing_deviation_J`, which are the rig's and its landings'; `landings` 0: no planned
    /// landing, both limits together whenever the landings' energy brings them there (see plan_of()).
    WearPlan plan;
    Rules rules;
    SurfaceTable floor;
    /// Surfaces on which the range must hold from the first landing on. All in the table, unless the file names them.
    std::vector<std::string> surfaces;
    /// Largest usable width of the interval of the brake's life forecast, relative to the plan's brake budget. 0: no forecast.
    double forecast_widest = 0.0;
    Deviations deviations;
    Prices prices;
    std::vector<std::filesystem::path> files;  ///< files that were read, for the hash of results

    /// allowed() with these surfaces and one more (empty: none).
    [[nodiscard]] Range range(const std::string& surface = {}) const;
    /// allowed() on one surface alone.
    [[nodiscard]] Range range_on(const std::string& surface) const;
};

/// "all", or names with commas between, of the table's surfaces. Throws std::invalid_argument naming an unknown one.
[[nodiscard]] std::vector<std::string> surfaces_of(const SurfaceTable& table, const std::string& text);

/// Reads `file` and the floor table that it names, which stands beside it. Throws settings::Error naming file, line and key.
[[nodiscard]] RegulationConfig load_regulation_config(const std::filesystem::path& file);

/// The table alone, e.g. one just characterised.
[[nodiscard]] SurfaceTable load_surface_table(const std::filesystem::path& file);
/// The same as TOML text; `made_by` is the command, for its first line.
[[nodiscard]] std::string to_toml(const SurfaceTable& table, const std::string& made_by);

/// The whole plan for a brake and the energy of its landings. Throws settings::Error if the brake has taken more than its life.
[[nodiscard]] WearPlan plan_of(const RegulationConfig& config, double brake_life_J, double landing_J, double landing_deviation_J);

}  // namespace wear
