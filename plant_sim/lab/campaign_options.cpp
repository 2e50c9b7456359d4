#include "plant_sim/lab/campaign_options.hpp"

#include <stdexcept>

#include "firmware/host/settings/config_directory.hpp"

namespace plant_sim::lab {

CLI::Option* CampaignOptions::add_to(CLI::App& verb, const std::string& what) {
    CLI::Option* const option = settings::existing_path(verb.add_option("SOURCE", source, what));
    verb.add_option("--campaign", campaign, "which of a ledger's campaigns; may be left out for one");
    add_out_of_tolerance_flag(verb, off);
    return option;
}

void PopulationOptions::add_to(CLI::App& verb) {
    auto* const given =
        settings::existing_file(verb.add_option("--model", model, "population.json of `wear population`, or model.json of `wear fit`"));
    verb.add_flag("--assume-made-up", assume_made_up, "go by config/wear/population.json, which is made up: for demonstrations")->excludes(given);
}

wear::PopulationFile PopulationOptions::read() const {
    if (model.empty() && !assume_made_up)
        throw std::invalid_argument(
            "no population of brakes like yours: learn one by `rig-lab wear population` and give it with --model; --assume-made-up goes by the "
            "one of the installation, whose brakes are made up and say nothing about a real one");
    return wear::read_population(model.empty() ? settings::config_directory() / "wear/population.json" : model);
}

void add_origin(CLI::App& verb, std::string& origin) {
    verb.add_option("--origin", origin, "of the campaigns, 'measured ...' or 'made up ...' (default: what they say of themselves)")
        ->check([](const std::string& text) { return wear::is_origin(text) ? std::string() : "an origin begins with 'measured' or 'made up'"; });
}

void add_out_of_tolerance_flag(CLI::App& verb, rig::replay::OutOfTolerance& off) {
    verb.add_flag_callback(
        "--out-of-tolerance", [&off] { off = rig::replay::OutOfTolerance::taken; }, "take a ledger's maneuvers that were out of tolerance, too");
}

}  // namespace plant_sim::lab
