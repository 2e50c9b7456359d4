/// The verbs of rig-lab, one per file: each adds its command line and returns the function that runs it.
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

/// Runs `work` in this process of the team that mpirun started, or alone; returns its exit status. An exception ends all processes.
[[nodiscard]] int in_team(const std::function<int(study::team::Team& team)>& work);

/// Number of threads for this process; `asked`: the user's, 0: not given.
[[nodiscard]] unsigned threads_in(const study::team::Team& team, unsigned asked);

struct LabVerb {
    CLI::App* app;             ///< the subcommand
    std::function<int()> run;  ///< its exit status
};

/// Runs the verb that the command line gives; 2: it gives none.
int run_parsed(std::span<const LabVerb> verbs);

/// One braking maneuver in closed loop.
LabVerb stop_verb(CLI::App& lab);
/// Open loop: the plant under a profile.
LabVerb drive_verb(CLI::App& lab);
/// The slip law against the threshold law on all surfaces and maneuvers.
LabVerb compare_verb(CLI::App& lab);
/// An endurance campaign in process.
LabVerb endurance_verb(CLI::App& lab);
/// Campaigns on a simulated disk that fails: counts losses.
LabVerb simulate_verb(CLI::App& lab);
/// Landings one after the other: finds slow growth.
LabVerb soak_verb(CLI::App& lab);
/// The set-point study of Section VI.
LabVerb sweep_verb(CLI::App& lab);
/// Regulation of wear through the slip reference, over seeded lives.
LabVerb regulate_verb(CLI::App& lab);
/// Regulation of a fleet with one workshop.
LabVerb regulate_fleet_verb(CLI::App& regulate);
/// The cheapest fixed slip reference, from a sweep.
LabVerb trade_verb(CLI::App& lab);
/// Phase and gain margins of the slip loop.
LabVerb margins_verb(CLI::App& lab);
/// Tunes gains by their margins.
LabVerb tune_verb(CLI::App& lab);
/// A scenario on the virtual rig, recorded as the bridge records it.
LabVerb maneuver_verb(CLI::App& lab);
/// A recorded braking in the plant, compared with the recorded motion.
LabVerb plant_verb(CLI::App& lab);
/// Valve, brake, wheel and road from recordings.
LabVerb identify_verb(CLI::App& lab);
/// Every fault in every phase of a stop, judged by criteria.
LabVerb faults_verb(CLI::App& lab);
/// Stops on drawn plants and runways.
LabVerb robust_verb(CLI::App& lab);
/// Friction over slip of every surface: Fig. 3.
LabVerb surfaces_verb(CLI::App& lab);
/// Every figure and table of the paper as one page.
LabVerb report_verb(CLI::App& lab);
/// Recorded maneuvers and what-if in a browser.
LabVerb panel_verb(CLI::App& lab);
/// What an endurance campaign tells of the brake, by the following verbs:
LabVerb wear_verb(CLI::App& lab);
/// A campaign as a table.
LabVerb wear_table_verb(CLI::App& wear);
/// Friction within a stop, from recorded stops: Fig. 6.
LabVerb wear_dynamics_verb(CLI::App& wear);
/// The mixture model from a campaign.
LabVerb wear_fit_verb(CLI::App& wear);
/// Repeats a campaign with the model's friction: Fig. 9.
LabVerb wear_simulate_verb(CLI::App& wear);
/// Differences between brakes of one kind, from several campaigns.
LabVerb wear_population_verb(CLI::App& wear);
/// Landings left.
LabVerb wear_forecast_verb(CLI::App& wear);
/// Health after each maneuver.
LabVerb wear_watch_verb(CLI::App& wear);
/// Comparison of forecasts on lives by rival laws.
LabVerb wear_arena_verb(CLI::App& wear);

/// Prints text for people on standard output, unless that is used by `--json -`.
template <typename... T>
void print_table(const std::string& json_file, fmt::format_string<T...> format, T&&... values) {
    if (json_file != "-") fmt::print(format, std::forward<T>(values)...);
}

/// Writes the result of a study to `file` and, if given, to `json_file`. If that is "-", standard output has the JSON, and the directory is named on
/// standard error, so that none is made silently.
void write_json(const std::filesystem::path& file, const std::string& json_file, std::string_view text);

}  // namespace plant_sim::lab
