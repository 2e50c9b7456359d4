/// The verbs of rig-lab, one a file: each adds its own command line and says how to run it.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <string>
#include <string_view>

namespace plant_sim {

struct LabVerb {
    CLI::App* app;             ///< the subcommand
    std::function<int()> run;  ///< its exit status
};

/// One braking maneuver in closed loop.
LabVerb stop_verb(CLI::App& lab);
/// Open loop: the plant alone under a profile.
LabVerb drive_verb(CLI::App& lab);
/// The slip law against the threshold law on all surfaces and maneuvers.
LabVerb compare_verb(CLI::App& lab);
/// An endurance campaign in process.
LabVerb endurance_verb(CLI::App& lab);
/// What an endurance campaign says about the brake; its verbs are in lab_wear.hpp.
LabVerb wear_verb(CLI::App& lab);

/// Text to a file, whole or not at all; "-" is standard output.
void deliver(const std::string& where, std::string_view text);

}  // namespace plant_sim
