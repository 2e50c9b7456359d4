/// What the verbs `margins` and `tune` go over: all surfaces and maneuvers of one configuration.
#pragma once

#include <string>
#include <vector>

#include "plant_sim/stop_options.hpp"
#include "plant_sim/study/margins/cells.hpp"
#include "plant_sim/study/margins/margins_settings.hpp"

namespace study::margins {

struct MarginsInput {
    MarginsSettings settings;                      ///< of margins.toml
    std::vector<plant_sim::StopInputs> scenarios;  ///< surface by surface
    std::vector<StopConditions> cases;             ///< the same, as the study takes them
    std::string config_hash;                       ///< plant, controller and margins.toml
};

/// Throws settings::Error. `options` names the directory, and what is the same for all.
[[nodiscard]] MarginsInput load_margins_input(const plant_sim::StopOptions& options);

}  // namespace study::margins
