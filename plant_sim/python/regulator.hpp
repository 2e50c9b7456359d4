/// The wear regulator for Python: rig_bridge/wear/regulator.hpp with the plan of config/regulation.toml.
#pragma once

#include <filesystem>
#include <optional>

#include "rig_bridge/wear/regulator.hpp"

namespace plant_sim::python {

struct RegulatorRequest {
    std::filesystem::path config;
    double landing_J = 0.0;  ///< expected mean, and standard deviation
    double landing_deviation_J = 0.0;
    std::optional<int> landings;  ///< none, also below: as in the file and in the brake's [brake.wear]
    std::optional<double> brake_life_J, tyre_life_J, brake_taken_J;
};

/// Throws settings::Error, or std::invalid_argument for an invalid plan.
[[nodiscard]] wear::Regulator regulator_of(const RegulatorRequest& request);

}  // namespace plant_sim::python
