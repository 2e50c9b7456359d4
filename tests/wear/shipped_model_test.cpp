/// The shipped campaign and model: made by what this says, and what the rigs' configurations take from them.
#include <fmt/format.h>

#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include "rig_bridge/wear/fit.hpp"
#include "rig_bridge/wear/learn_population.hpp"
#include "rig_bridge/wear/model_io.hpp"
#include "rig_bridge/wear/on_threads.hpp"
#include "rig_bridge/wear/population_io.hpp"
#include "rig_bridge/wear/wearing_brake.hpp"
#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"
#include "tests/wear/fleet.hpp"
#include "tests/wear/physical_campaign.hpp"

namespace {

const std::string kCampaign = "config/wear/endurance_campaign.csv";
const std::string kModel = "config/wear/model.json";
const std::string kPopulation = "config/wear/population.json";

std::string made_up_campaign() {
    std::string csv =
        "# MADE UP, not measured [A]: 500 maneuvers of Table III on the brake of flywheel_rig.toml, new to "
        "worn "
        "out, by the physical law of\n"
        "# tests/wear/physical_campaign.hpp (contact that runs in, lining that wears, core that loses grip; "
        "scatter that remembers), seed 1.\n"
        "# Put your own rig's campaign in its place. Made by: build/release/tests/wear/test_wear_shipped "
        "'[.regenerate]'\n"
        "# origin: made up by the law of tests/wear/physical_campaign.hpp, seed 1\n"
        "maneuver,mean_friction,cumulative_energy_MJ\n";
    const wear::Campaign campaign = physical::campaign(physical::shipped_law(), 1);
    for (std::size_t i = 0; i < campaign.points.size(); ++i)
        fmt::format_to(std::back_inserter(csv), "{},{:.5f},{:.4f}\n", i + 1, campaign.points[i].mean_friction, campaign.points[i].c_e_J * 1e-6);
    return csv;
}

std::string fitted_model() {
    const wear::FitSettings settings{.seed = 1, .em = {}};
    const wear::Campaign data = wear::read_campaign(kCampaign);
    return wear::to_json(wear::model_of(data, wear::fit(data, settings, {2, {}, {}}), settings));
}

wear::Population made_up_population() {
    const auto brakes = [](std::uint64_t first, std::uint64_t count) {
        std::vector<wear::Campaign> out;
        for (std::uint64_t seed = first; seed < first + count; ++seed) {
            out.push_back(physical::worn_out(seed).campaign);
            out.back().source = fmt::format("brake of seed {}", seed);
        }
        return out;
    };
    wear::LearnSettings settings;
    settings.limit = 0.2;
    settings.healthy = brakes(10000, 1000);
    settings.threads = wear::all_cores();
    return wear::learn_population(brakes(1000, 40), settings);
}

}  // namespace

TEST_CASE("the shipped campaign is what the physical law makes of seed 1", "[WEAR-011]") {
    CHECK(content_of(kCampaign) == made_up_campaign());
}

TEST_CASE("the shipped model is what `rig-lab wear fit` makes of the shipped campaign", "[WEAR-011]") {
    CHECK(content_of(kModel) == fitted_model());
}

TEST_CASE("the shipped population says that it is made up, and is what its law makes of its seeds", "[.population][WEAR-071]") {
    const wear::Population shipped = wear::read_population(kPopulation).population;
    CHECK(shipped.provenance.made_up());
    CHECK(shipped.provenance.lives == 40);
    CHECK(shipped == made_up_population());
}

TEST_CASE("writes the shipped campaign, model and population anew", "[.regenerate]") {
    put(kCampaign, made_up_campaign());
    put(kModel, fitted_model());
    put(kPopulation, wear::to_json(made_up_population()));
}
