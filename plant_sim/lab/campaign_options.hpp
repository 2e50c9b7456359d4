/// Options of verbs that learn from campaigns or judge by what was learnt.
#pragma once

#include <filesystem>
#include <string>

#include "firmware/host/settings/command_line.hpp"
#include "rig_bridge/replay/campaign_source.hpp"
#include "rig_bridge/wear/population_io.hpp"

namespace plant_sim::lab {

using rig::replay::load_campaign;
using rig::replay::load_campaigns;
using rig::replay::OutOfTolerance;

/// --model and --assume-made-up of a verb that judges a brake by others.
struct PopulationOptions {
    std::filesystem::path model;  ///< empty: the shipped one, which is made up, and only when that is asked for
    bool assume_made_up = false;

    void add_to(CLI::App& verb);
    /// Throws std::invalid_argument when neither is given, settings::Error for a file that is none.
    [[nodiscard]] wear::PopulationFile read() const;
};

/// --origin of a verb that learns: what its campaigns say of themselves, unless it is given.
void add_origin(CLI::App& verb, std::string& origin);

/// --out-of-tolerance of a verb that reads campaigns.
void add_out_of_tolerance_flag(CLI::App& verb, OutOfTolerance& off);

}  // namespace plant_sim::lab
