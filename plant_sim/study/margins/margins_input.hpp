/// What the verbs `margins` and `tune` go over: all surfaces and maneuvers of one configuration.
#pragma once

#include <string>
#include <vector>

#include "plant_sim/stop_options.hpp"
#include "plant_sim/study/margins/cells.hpp"
#include "plant_sim/study/margins/margins_settings.hpp"

namespace plant_sim::lab {

struct MarginsInput {
    study::margins::MarginsSettings settings;           ///< of margins.toml
    std::vector<StopInputs> scenarios;                  ///< surface by surface
    std::vector<study::margins::StopConditions> cases;  ///< the same, as the study takes them
    std::string config_hash;                            ///< plant, controller and margins.toml
};

/// Throws settings::Error. `options` names the directory, and what is the same for all.
[[nodiscard]] MarginsInput load_margins_input(const StopOptions& options);

}  // namespace plant_sim::lab
