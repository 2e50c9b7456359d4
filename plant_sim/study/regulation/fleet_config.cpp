#include "plant_sim/study/regulation/fleet_config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <sstream>
#include <string>

#include "firmware/host/settings/csv_field.hpp"
#include "firmware/host/settings/settings.hpp"

namespace regulation {

namespace {

using wear::arena::kLawNames;

std::vector<wear::arena::Law> laws_in(const settings::Table& set) {
    std::vector<wear::arena::Law> laws;
    std::istringstream in(set.text("laws"));
    for (std::string name; std::getline(in, name, ',');) {
        const auto* const known = std::find(kLawNames.begin(), kLawNames.end(), settings::trimmed(name));
        if (known == kLawNames.end())
            set.fail("laws", fmt::format("'{}' is no law of wear: expected some of {}, with commas between", settings::trimmed(name),
                                         fmt::join(kLawNames, ", ")));
        laws.push_back(static_cast<wear::arena::Law>(std::distance(kLawNames.begin(), known)));
    }
    return laws;
}

FleetSet set_in(const settings::Table& set) {
    return {.laws = laws_in(set),
            .first_seed = set.integer<std::uint64_t>("first_seed", {.min = 0, .max = 1'000'000'000'000}),
            .fleets = set.integer<int>("fleets", {.min = 2, .max = 1000})};
}

}  // namespace

FleetConfig load_fleet_config(const std::filesystem::path& file) {
    const settings::Document doc = settings::Document::load(file);
    const settings::Table root = doc.root(), fleet = root.table("fleet"), shop = root.table("shop");
    FleetConfig config{.aircraft = fleet.integer<int>("aircraft", {.min = 1, .max = kMaxAircraft}),
                       .rules = {},
                       .inspection_landings = fleet.integer<int>("inspection_landings", {.min = 1, .max = 1'000'000}),
                       .tuning = set_in(root.table("tuning")),
                       .held_out = set_in(root.table("held_out"))};
    config.rules.landings_a_day = fleet.integer<int>("landings_a_day", {.min = 1, .max = 100});
    config.rules.days = fleet.integer<int>("days", {.min = 1, .max = 100'000});
    config.rules.ground_day = fleet.number("ground_day", {.min = 0.0, .max = 1e9});
    config.rules.shop.bays = shop.integer<int>("bays", {.min = 1, .max = kMaxAircraft});
    config.rules.shop.visit_days = shop.integer<int>("visit_days", {.min = 1, .max = 1000});
    doc.finish();
    for (const auto law : config.tuning.laws)
        if (std::find(config.held_out.laws.begin(), config.held_out.laws.end(), law) != config.held_out.laws.end())
            root.table("held_out").fail("laws", "has a law of [tuning]: what is tuned on one is judged on others");
    return config;
}

}  // namespace regulation
