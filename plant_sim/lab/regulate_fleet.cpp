#include <fmt/core.h>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/stop_signals.hpp"
#include "plant_sim/lab/regulate_fleet_report.hpp"
#include "plant_sim/lab/regulate_stops.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "rig_bridge/wear/on_threads.hpp"

namespace plant_sim::lab {

namespace {

using regulation::Choice;

struct RegulateFleetCommand {
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path out = "out/fleet";
    std::string json_file;  ///< "-": standard output
    std::optional<int> aircraft, bays, visit_days, fleets;
    std::optional<double> ground_day;
    std::optional<std::uint64_t> seed;
    unsigned threads = wear::all_cores();

    [[nodiscard]] int run() const {
        const wear::RegulationConfig owner = wear::load_regulation_config(config / "regulation.toml");
        const std::filesystem::path arena_file = config / "wear_arena.toml", fleet_file = config / "fleet.toml";
        regulation::FleetConfig asked = regulation::load_fleet_config(fleet_file);
        asked.aircraft = aircraft.value_or(asked.aircraft);
        asked.rules.shop.bays = bays.value_or(asked.rules.shop.bays);
        asked.rules.shop.visit_days = visit_days.value_or(asked.rules.shop.visit_days);
        asked.rules.ground_day = ground_day.value_or(asked.rules.ground_day);
        asked.rules.prices = owner.prices;
        asked.held_out.first_seed = seed.value_or(asked.held_out.first_seed);
        asked.held_out.fleets = fleets.value_or(asked.held_out.fleets);
        const LandingSites sites = load_sites(config);
        antiskid::host::StopSignals signals;
        regulation::FleetStudy study = study_of(owner, asked, sites, wear::arena::load_settings(arena_file));
        study.threads = threads;
        study.stop = &signals.stop();
        const auto count = [](const regulation::FleetSet& set) { return static_cast<std::int64_t>(set.laws.size()) * set.fleets; };
        settings::Progress progress(count(asked.tuning) + count(asked.held_out), 0, "fleets");
        study.on_fleets = [&](std::size_t done) { progress.show(static_cast<std::int64_t>(done)); };
        const std::vector<Choice> references = references_of(owner);
        FleetReport report{.config = asked, .policies = regulation::judge(study, regulation::entrants(study, references)), .config_hash = {}};
        progress.finish();
        if (report.policies.empty()) return signals.exit_status();
        std::vector<std::filesystem::path> files = sites.files;
        files.insert(files.end(), owner.files.begin(), owner.files.end());
        files.insert(files.end(), {arena_file, fleet_file});
        report.config_hash = settings::hash(files);
        print_table(json_file, "{}", to_text(report));
        write_json(out / "fleet.json", json_file, to_json(report));
        settings::write_file(out / "visits.csv", to_csv(report));
        draw(report, out / "fleet.png");
        print_table(json_file, "  {}, {}, {}\n", (out / "fleet.json").string(), (out / "visits.csv").string(), (out / "fleet.png").string());
        return 0;
    }

  private:
    [[nodiscard]] static regulation::FleetStudy study_of(const wear::RegulationConfig& owner, const regulation::FleetConfig& asked,
                                                         const LandingSites& sites, const wear::arena::Settings& arena) {
        const double brake_life_J = sites.sites.front().rig.wear.life_J;
        regulation::AircraftKind kind{.landing_J = {},
                                      .law = {},
                                      .brakes = arena,
                                      .past = {},
                                      .tyre_life_J = owner.plan.tyre_life_J,
                                      .deviations = owner.deviations,
                                      .inspection_landings = asked.inspection_landings};
        for (const LandingSite& site : sites.sites)  // a maneuver brings the same energy on every surface
            if (site.surface == sites.sites.front().surface) kind.landing_J.push_back(site.kinetic_J());
        const Choice usual = regulation::choice_of(owner.floor, owner.rules.default_reference);
        const double brake_J = (1.0 - usual.mean_share) * kind.mean_landing_J();
        kind.brakes.mix = {{.name = "landing", .share = 1.0, .energy_J = brake_J, .deviation_J = 0.0}};
        kind.brakes.life_landings = brake_life_J / brake_J;
        kind.brakes.life_scatter = owner.deviations.brake;
        const regulation::Costs costs{.brake_per_J = owner.prices.brake / brake_life_J,
                                      .tyre_per_J = owner.prices.tyre / kind.tyre_life_J,
                                      .visit = owner.prices.visit + asked.rules.shop.visit_days * asked.rules.ground_day,
                                      .metre = owner.prices.metre,
                                      .planned = {.brake_J = brake_life_J, .tyre_J = kind.tyre_life_J}};
        return {.kind = std::move(kind),
                .choices = regulation::Choices(owner.floor, owner.rules.j_mu_floor, owner.rules.default_reference),
                .costs = costs,
                .config = asked,
                .training_seed = arena.training};
    }
    /// The default one, then all that are allowed on every surface.
    [[nodiscard]] static std::vector<Choice> references_of(const wear::RegulationConfig& owner) {
        std::vector<Choice> all{regulation::choice_of(owner.floor, owner.rules.default_reference)};
        constexpr std::size_t kEvery = 2;  // of the table's references
        const std::vector<double> allowed = wear::references_in(owner.floor, owner.range());
        all.reserve(1 + allowed.size());
        for (std::size_t i = 0; i < allowed.size(); i += kEvery) all.push_back(regulation::choice_of(owner.floor, allowed[i]));
        return all;
    }
};

}  // namespace

LabVerb regulate_fleet_verb(CLI::App& regulate) {
    const auto command = std::make_shared<RegulateFleetCommand>();
    CLI::App* verb =
        regulate.add_subcommand("fleet",
                                "Several aircraft and one shop: whether it saves money to move wear between brake and tyre so that visits "
                                "are shared and do not collide. By the table of surfaces.");
    const auto number = [&](const char* option, std::optional<int>& value, int max, const char* text) {
        verb->add_option(option, value, text)->check(CLI::Range(1, max));
    };
    number("--aircraft", command->aircraft, regulation::kMaxAircraft, "of each fleet (default: the one of fleet.toml)");
    number("--bays", command->bays, regulation::kMaxAircraft, "of the shop (default: likewise)");
    number("--visit-days", command->visit_days, 1000, "that a visit takes (default: likewise)");
    verb->add_option("--ground-day", command->ground_day, "money that an aircraft on the ground costs a day (default: likewise)")
        ->check(CLI::Range(0.0, 1e9));
    verb->add_option("--fleets", command->fleets, "judged, of each law of wear (default: likewise)")->check(CLI::Range(2, 1000));
    verb->add_option("--seed", command->seed, "of the first aircraft that is judged (default: likewise)")->check(CLI::NonNegativeNumber);
    settings::add_json(*verb, command->json_file, "results");
    settings::add_out(*verb, command->out, "directory for fleet.json, visits.csv, fleet.png");
    settings::add_config_directory(*verb, command->config);
    settings::add_threads(*verb, command->threads);
    verb->footer(
        "Examples:\n"
        "  rig-lab regulate fleet\n"
        "  rig-lab regulate fleet --aircraft 24 --ground-day 500\n"
        "  rig-lab regulate fleet --bays 2 --visit-days 5 --out out/two_bays");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim::lab
