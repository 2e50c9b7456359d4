/// Inputs of the verbs `margins` and `tune`: all surfaces and maneuvers of one configuration.
#pragma once

#include <string>
#include <vector>

#include "plant_sim/scenario/stop_options.hpp"
#include "plant_sim/study/margins/cells.hpp"
#include "plant_sim/study/margins/margins_settings.hpp"

namespace study::margins {

struct MarginsInput {
    MarginsSettings settings;                      ///< from margins.toml
    std::vector<plant_sim::StopInputs> scenarios;  ///< surface by surface
    std::vector<StopConditions> cases;             ///< the same, as the study uses them
    std::string config_hash;                       ///< of plant, controller and margins.toml
};

/// Throws settings::Error. `options`: the directory, and the options common to all scenarios.
[[nodiscard]] MarginsInput load_margins_input(const plant_sim::StopOptions& options);

}  // namespace study::margins
