/// The verbs of rig-lab, one a file: each adds its own command line and says how to run it.
#pragma once

#include <fmt/core.h>

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "firmware/host/settings/command_line.hpp"
#include "plant_sim/study/team/team.hpp"

namespace plant_sim::lab {

/// `work` in this process of the team that mpirun started, or alone; its exit status. What it throws ends all processes.
[[nodiscard]] int in_team(const std::function<int(study::team::Team& team)>& work);

/// Threads of this process where `asked` were asked for, 0 for no wish.
[[nodiscard]] unsigned threads_in(const study::team::Team& team, unsigned asked);

struct LabVerb {
    CLI::App* app;             ///< the subcommand
    std::function<int()> run;  ///< its exit status
};

/// Runs the verb that the command line named; 2 if it named none.
int run_parsed(std::span<const LabVerb> verbs);

/// One braking maneuver in closed loop.
LabVerb stop_verb(CLI::App& lab);
/// Open loop: the plant alone under a profile.
LabVerb drive_verb(CLI::App& lab);
/// The slip law against the threshold law on all surfaces and maneuvers.
LabVerb compare_verb(CLI::App& lab);
/// An endurance campaign in process.
LabVerb endurance_verb(CLI::App& lab);
/// Campaigns on a simulated disk that fails: what is lost.
LabVerb simulate_verb(CLI::App& lab);
/// Landings back to back: what creeps.
LabVerb soak_verb(CLI::App& lab);
/// The set-point study of Section VI.
LabVerb sweep_verb(CLI::App& lab);
/// Regulation of wear through the slip reference, over seeded lives.
LabVerb regulate_verb(CLI::App& lab);
/// The cheapest fixed slip reference, from a sweep.
LabVerb trade_verb(CLI::App& lab);
/// Phase and gain margins of the slip loop.
LabVerb margins_verb(CLI::App& lab);
/// Gains by their margins.
LabVerb tune_verb(CLI::App& lab);
/// A scenario on the virtual rig, recorded as the bridge records it.
LabVerb maneuver_verb(CLI::App& lab);
/// A recorded braking through the plant, held against the recorded motion.
LabVerb plant_verb(CLI::App& lab);
/// Valve, brake, wheel and road from recordings.
LabVerb identify_verb(CLI::App& lab);
/// Every fault in every phase of a stop, against criteria.
LabVerb faults_verb(CLI::App& lab);
/// Stops on drawn plants and runways.
LabVerb robust_verb(CLI::App& lab);
/// Friction over slip of every surface: Fig. 3.
LabVerb surfaces_verb(CLI::App& lab);
/// Every figure and table of the paper as one page.
LabVerb report_verb(CLI::App& lab);
/// Recorded maneuvers and what-if in a browser.
LabVerb panel_verb(CLI::App& lab);
/// What an endurance campaign says about the brake, by these verbs of its own:
LabVerb wear_verb(CLI::App& lab);
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
/// Forecasts against each other on lives by rival laws.
LabVerb wear_arena_verb(CLI::App& wear);

/// For people: on standard output, unless `--json -` has it for itself.
template <typename... T>
void print_table(const std::string& json_file, fmt::format_string<T...> format, T&&... values) {
    if (json_file != "-") fmt::print(format, std::forward<T>(values)...);
}

/// The result of a study, in its directory and where --json says. Where that is standard output, which is to be read by programs, the directory is
/// named on standard error: none is made silently.
void keep_json(const std::filesystem::path& file, const std::string& json_file, std::string_view text);

}  // namespace plant_sim::lab
