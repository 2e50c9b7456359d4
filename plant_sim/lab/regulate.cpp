#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/stop_signals.hpp"
#include "plant_sim/lab/regulate_report.hpp"
#include "plant_sim/lab/regulate_stops.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/regulation/bound.hpp"
#include "rig_bridge/wear/on_threads.hpp"

namespace plant_sim::lab {

namespace {

using regulation::Mix;

struct RegulateCommand {
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path regulation_file;  ///< empty: regulation.toml of `config`
    std::filesystem::path out = "out/regulate";
    std::string json_file;                ///< "-": standard output
    std::filesystem::path characterised;  ///< write the floor table here instead
    int lives = 24;
    std::vector<double> fixed{0.24};
    int landings = 0;  ///< 0: the plan's
    std::uint64_t seed = 1;
    Mix mix = Mix::random;
    double missing = 0.0;
    std::optional<double> life_deviation, tyre_deviation, inspection_error;  ///< none: as the file believes
    int inspection = 32;
    std::string surfaces;  ///< empty: the file's
    bool by_table = false;
    bool floor_check = true;
    unsigned threads = wear::all_cores();

    [[nodiscard]] int run() const {
        if (!characterised.empty()) return characterise();
        wear::RegulationConfig asked = wear::load_regulation_config(regulation_file.empty() ? config / "regulation.toml" : regulation_file);
        if (!surfaces.empty()) asked.surfaces = wear::surfaces_of(asked.floor, surfaces);
        const LandingSites sites = load_sites(config);
        const wear::BrakeWear& brake = sites.sites.front().rig.wear;
        RegulateReport report;
        report.plan = wear::plan_of(asked, brake.life_J, sites.mean_J(), sites.deviation_J());
        if (landings > 0) report.plan.landings = landings;
        report.rules = asked.rules;
        report.range = asked.range();
        report.limits = wear::limit_forecast(wear::Regulator(report.plan, report.rules, report.range));
        regulation::LivesOptions& options = report.options;
        options.lives = lives;
        options.seed = seed;
        options.mix = mix;
        options.missing = missing;
        options.brake_deviation = life_deviation.value_or(asked.deviations.brake);
        options.tyre_deviation = tyre_deviation.value_or(asked.deviations.tyre);
        options.each.inspection = {.landings = inspection,
                                   .error = inspection_error.value_or(asked.deviations.inspection),
                                   .brake_spread = asked.deviations.brake,
                                   .tyre_spread = asked.deviations.tyre};
        options.each.references.emplace(asked.floor, asked.rules.j_mu_floor, asked.rules.default_reference);
        constexpr double kWidest = 0.15;  // of a forecast's interval, over the plan's budget, where the file does not say
        options.each.life_forecast.emplace(wear::forecast_model(brake), brake,
                                           (asked.forecast_widest > 0.0 ? asked.forecast_widest : kWidest) * report.plan.brake_budget_J());
        options.each.costs = regulation::costs_of(asked.prices, report.plan);
        options.scenarios = sites.sites.size();
        options.worst_stops = floor_check && !by_table;
        for (const LandingSite& site : sites.sites) {
            options.each.allowed_on.push_back(asked.range_on(site.surface));
            options.each.surface_of.push_back(static_cast<std::size_t>(asked.floor.find(site.surface) - asked.floor.rows.data()));
        }
        const regulation::BoundProblem problem = problem_of(asked, sites, report.plan, options);
        std::array<std::optional<regulation::Bound>, 2> bounds;  // told the surface, and not
        wear::run_jobs(threads, bounds.size(), [&](std::size_t i) {
            regulation::BoundProblem one = problem;
            one.told = i == 0;
            bounds.at(i).emplace(std::move(one));
        });
        options.each.bound = &*bounds[0];
        report.cost_bound = bounds[0]->per_landing();
        report.cost_untold = bounds[1]->per_landing();
        report.cost_unshared = regulation::cost_unshared(problem);
        antiskid::host::StopSignals signals;
        const std::vector<regulation::Policy> all = policies(asked, report.plan, report.range);
        const int stops_a_life = static_cast<int>(all.size()) + (options.worst_stops ? 2 : 0);
        const std::int64_t planned = std::int64_t{lives} * stops_a_life * report.plan.landings;
        settings::Progress progress(planned, 0);
        options.stop = &signals.stop();
        options.on_stops = [&](std::size_t done) {  // lives that bring less than planned go on beyond it
            progress.show(std::min(static_cast<std::int64_t>(done), planned));
        };
        report.policies = regulation::run_lives(report.plan, report.rules, report.range, all, brake, options,
                                                [&](std::span<const regulation::LandingRequest> requests) {
                                                    return by_table ? land_by_table(sites, asked.floor, requests) : land(sites, requests, threads);
                                                });
        progress.finish();
        if (report.policies.empty()) return signals.exit_status();
        std::vector<std::filesystem::path> files = sites.files;
        files.insert(files.end(), asked.files.begin(), asked.files.end());
        report.config_hash = settings::hash(files);
        print_table(json_file, "{}", to_text(report));
        write_json(out / "results.json", json_file, to_json(report));
        settings::write_file(out / "landings.csv", to_csv(report));
        draw(report, out / "regulate.png");
        print_table(json_file, "  {}, {}, {}\n", (out / "results.json").string(), (out / "landings.csv").string(), (out / "regulate.png").string());
        return report.all_met() ? 0 : 1;
    }

  private:
    /// The lives' pairs as they really are, on landings as the sites make them.
    [[nodiscard]] static regulation::BoundProblem problem_of(const wear::RegulationConfig& asked, const LandingSites& sites,
                                                             const wear::WearPlan& plan, const regulation::LivesOptions& options) {
        regulation::BoundProblem problem{.table = asked.floor, .allowed = {}, .landing_J = {}, .costs = options.each.costs, .begins = {}};
        for (const wear::SurfaceTable::Row& row : asked.floor.rows) problem.allowed.push_back(asked.range_on(row.surface));
        for (const LandingSite& site : sites.sites) {  // a maneuver brings the same energy on every surface
            if (site.surface == sites.sites.front().surface) problem.landing_J.push_back(site.kinetic_J());
        }
        for (std::uint64_t life = 0; life < static_cast<std::uint64_t>(options.lives); ++life) {
            const regulation::Truth truth = regulation::truth_of(plan, sites.sites.front().rig.wear, options, life);
            problem.begins.push_back({truth.brake.life_J - plan.brake_taken_J, truth.tyre_life_J - plan.tyre_taken_J});
        }
        return problem;
    }
    [[nodiscard]] int characterise() const {
        const LandingSites sites = load_sites(config);
        antiskid::host::StopSignals signals;
        CharacteriseOptions options{.references = {}, .seed = seed, .threads = threads, .stop = &signals.stop()};
        constexpr int kFirst = 6;  // hundredths, as in the paper's study
        constexpr int kLast = 50;
        for (int k = kFirst; k <= kLast; k += 2) options.references.push_back(k / 100.0);
        settings::Progress progress(static_cast<std::int64_t>(characterising_stops(sites, options)), 0);
        options.on_stops = [&](std::size_t stops) { progress.show(static_cast<std::int64_t>(stops)); };
        const wear::SurfaceTable table = plant_sim::lab::characterise(sites, options);
        progress.finish();
        if (table.rows.empty()) return signals.exit_status();
        settings::write_file(characterised, wear::to_toml(table, fmt::format("rig-lab regulate --seed {} --characterise FILE", seed)));
        print_table(json_file, "{}: {} references on {} surfaces\n", characterised.string(), table.reference.size(), table.rows.size());
        return 0;
    }
    [[nodiscard]] std::vector<regulation::Policy> policies(const wear::RegulationConfig& asked, const wear::WearPlan& plan,
                                                           const wear::Range& range) const {
        const double best = regulation::best_fixed(plan, asked.floor, range);
        constexpr int kByHand = 64;  // landings between two visits of who sets the reference by hand
        std::vector<regulation::Policy> all{{.name = "one reference for all"},
                                            {.name = "told the surface", .told = true},
                                            {.name = "one reference without inspection", .inspected = false},
                                            {.name = "one reference by the forecast", .inspected = false, .forecast = true},
                                            {.name = "reset by hand every 64 landings", .every = kByHand}};
        for (const double reference : fixed) {
            if (std::abs(reference - best) > 1e-6) all.push_back({.name = fmt::format("fixed {:.2f}", reference), .fixed = reference});
        }
        all.push_back({.name = fmt::format("best fixed {:.2f}", best), .fixed = best});
        all.push_back({.name = "the bound's own", .bound = true});
        return all;
    }
};

}  // namespace

LabVerb regulate_verb(CLI::App& lab) {
    const auto command = std::make_shared<RegulateCommand>();
    CLI::App* verb = lab.add_subcommand("regulate",
                                        "Regulation of wear: landing by landing the next slip reference from measured brake and tyre energy, so that "
                                        "both reach their limits together; seeded lives of random landings against fixed references.");
    verb->add_option("--lives", command->lives, "how many")->check(CLI::Range(1, 10'000))->capture_default_str();
    verb->add_option("--fixed", command->fixed, "references to compare with, beside the one that the characterised shares call best")
        ->check(CLI::Range(0.01, 0.5))
        ->capture_default_str();
    verb->add_option("--landings", command->landings, "planned landing, instead of the plan's")->check(CLI::Range(2, 1'000'000));
    settings::add_seed(*verb, command->seed)->check(CLI::NonNegativeNumber);
    settings::add_choice(*verb, "--mix", command->mix, {{"random", Mix::random}, {"balanced", Mix::balanced}},
                         "random: each landing any surface and maneuver; balanced: all equally often, in random order");
    verb->add_option("--missing", command->missing, "share of landings whose measurements are lost")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    const auto deviation = [&](const char* option, std::optional<double>& value, const char* text) {
        verb->add_option(option, value, text)->check(CLI::Range(0.0, 0.5));
    };
    deviation("--life-deviation", command->life_deviation,
              "brakes differ in how long they last by this share, lognormal standard deviation (default: the regulation file's)");
    deviation("--tyre-deviation", command->tyre_deviation, "tyres do by this share (default: the regulation file's)");
    deviation("--inspection-error", command->inspection_error,
              "standard deviation of the worn part that an inspection reads, over the whole of a new one (default: the regulation file's)");
    verb->add_option("--inspection", command->inspection,
                     "landings between two inspections of brake and tyre, the first at the plan's begin; 0: none")
        ->check(CLI::Range(0, 1'000'000))
        ->capture_default_str();
    verb->add_option("--surfaces", command->surfaces,
                     "seen before the plan's begin, with commas between, or all: others bound the references from their first landing on (default: "
                     "the regulation file's)");
    verb->add_flag("--by-table", command->by_table, "land by the table of surfaces, not in closed loop: hundreds of lives in seconds");
    verb->add_flag("!--no-floor-check", command->floor_check, "do not make every regulated landing again at both ends of the range");
    settings::existing_file(verb->add_option("--regulation", command->regulation_file, "plan and rules (default: CONFIG/regulation.toml)"));
    settings::result_file(verb->add_option("--characterise", command->characterised,
                                           "only measure what references give on each surface, and write that table to this file"));
    settings::add_json(*verb, command->json_file, "results");
    settings::add_out(*verb, command->out, "directory for results.json, landings.csv, regulate.png");
    settings::add_config_directory(*verb, command->config);
    settings::add_threads(*verb, command->threads);
    const LabVerb fleet = regulate_fleet_verb(*verb);
    verb->footer(
        "Examples:\n"
        "  rig-lab regulate\n"
        "  rig-lab regulate --lives 4 --mix balanced --out out/balanced\n"
        "  rig-lab regulate --by-table --lives 400 --inspection-error 0.05\n"
        "  rig-lab regulate --surfaces dry_asphalt,wet_asphalt\n"
        "  rig-lab regulate --characterise config/regulation_floor.toml\n"
        "Exit status: 0 both limits met in every life where that was feasible, and no stop beyond the floor; 1 not so; 2 mistake on the command line "
        "or in a configuration file; 130 stopped by Ctrl-C.");
    return {verb, [command, fleet] { return fleet.app->parsed() ? fleet.run() : command->run(); }};
}

}  // namespace plant_sim::lab
