/// The verbs of `rig-lab wear`, one a file.
#pragma once

#include "plant_sim/lab_verbs.hpp"

namespace plant_sim {

/// A campaign as a table.
LabVerb wear_table_verb(CLI::App& wear);
/// The mixture model from a campaign.
LabVerb wear_fit_verb(CLI::App& wear);
/// A campaign again, with the model's friction: Fig. 9.
LabVerb wear_simulate_verb(CLI::App& wear);

}  // namespace plant_sim
