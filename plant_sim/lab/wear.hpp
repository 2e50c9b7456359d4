/// The verbs of `rig-lab wear`, one a file.
#pragma once

#include "plant_sim/lab/verbs.hpp"

namespace plant_sim::lab {

/// A campaign as a table.
LabVerb wear_table_verb(CLI::App& wear);
/// Friction within a stop, from recorded stops: Fig. 6.
LabVerb wear_dynamics_verb(CLI::App& wear);
/// The mixture model from a campaign.
LabVerb wear_fit_verb(CLI::App& wear);
/// A campaign again, with the model's friction: Fig. 9.
LabVerb wear_simulate_verb(CLI::App& wear);
/// How brakes of one kind differ, from several campaigns.
LabVerb wear_population_verb(CLI::App& wear);
/// Landings left.
LabVerb wear_forecast_verb(CLI::App& wear);
/// Health, maneuver by maneuver.
LabVerb wear_watch_verb(CLI::App& wear);

}  // namespace plant_sim::lab
