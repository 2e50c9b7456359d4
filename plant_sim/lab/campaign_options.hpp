/// Options of verbs that learn from campaigns or judge with a learnt model.
#pragma once

#include <filesystem>
#include <string>

#include "firmware/host/settings/command_line.hpp"
#include "rig_bridge/replay/campaign_source.hpp"
#include "rig_bridge/wear/population_io.hpp"

namespace plant_sim::lab {

/// SOURCE, --campaign and --out-of-tolerance of verbs that read a campaign.
struct CampaignOptions {
    std::filesystem::path source;
    std::string campaign;  ///< of a ledger; empty: the only one
    rig::replay::OutOfTolerance off = rig::replay::OutOfTolerance::left_out;

    /// Returns SOURCE; `what`: its description.
    CLI::Option* add_to(CLI::App& verb, const std::string& what);
    /// Throws settings::Error.
    [[nodiscard]] wear::Campaign load() const { return rig::replay::load_campaign(source, campaign, off); }
};

/// --model and --assume-made-up of verbs that judge a brake by a population.
struct PopulationOptions {
    std::filesystem::path model;  ///< empty: the shipped one, which is made up and needs `assume_made_up`
    bool assume_made_up = false;

    void add_to(CLI::App& verb);
    /// Throws std::invalid_argument if neither is given, settings::Error for a file that is not a population.
    [[nodiscard]] wear::PopulationFile read() const;
};

/// Adds --origin of verbs that learn; by default the campaigns' own origin.
void add_origin(CLI::App& verb, std::string& origin);

/// Adds --out-of-tolerance of verbs that read several campaigns.
void add_out_of_tolerance_flag(CLI::App& verb, rig::replay::OutOfTolerance& off);

}  // namespace plant_sim::lab
