#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/stop_signals.hpp"
#include "plant_sim/lab/regulate_report.hpp"
#include "plant_sim/lab/regulate_stops.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "rig_bridge/wear/on_threads.hpp"

namespace plant_sim::lab {

namespace {

using regulation::Mix;

constexpr int kStopped = 130;

struct RegulateCommand {
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path regulation_file;  ///< empty: regulation.toml of `config`
    std::filesystem::path out = "out/regulate";
    std::string json_file;                ///< "-": standard output
    std::filesystem::path characterised;  ///< write the floor table here instead
    int lives = 24;
    std::vector<double> fixed{0.10, 0.24, 0.40};
    int landings = 0;  ///< 0: the plan's
    std::uint64_t seed = 1;
    Mix mix = Mix::random;
    double missing = 0.0;
    double brake_deviation = 0.0;
    int inspection = 32;
    std::string surfaces;  ///< empty: the file's
    bool forecast = true;
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
        for (const LandingSite& site : sites.sites) report.options.allowed_on.push_back(asked.range_on(site.surface));
        if (forecast && asked.forecast_widest > 0.0)
            report.options.life_forecast.emplace(wear::forecast_model(brake), brake, asked.forecast_widest * report.plan.brake_budget_J());
        antiskid::host::StopSignals signals;
        const std::vector<regulation::Policy> all = policies(asked, report.plan, report.range);
        const int stops_a_life = static_cast<int>(all.size()) + (floor_check ? 2 : 0);
        const std::int64_t planned = std::int64_t{lives} * stops_a_life * report.plan.landings;
        settings::Progress progress(planned, 0);
        report.options.lives = lives;
        report.options.seed = seed;
        report.options.mix = mix;
        report.options.missing = missing;
        report.options.brake_deviation = brake_deviation;
        report.options.inspection = inspection;
        report.options.scenarios = sites.sites.size();
        report.options.worst_stops = floor_check;
        report.options.stop = &signals.stop();
        report.options.on_stops = [&](std::size_t done) {  // lives that bring less than planned go on beyond it
            progress.show(std::min(static_cast<std::int64_t>(done), planned));
        };
        report.policies = regulation::run_fleet(report.plan, report.rules, report.range, all, brake, report.options,
                                                [&](std::span<const regulation::LandingRequest> requests) { return land(sites, requests, threads); });
        progress.finish();
        if (report.policies.empty()) return kStopped;
        std::vector<std::filesystem::path> files = sites.files;
        files.insert(files.end(), asked.files.begin(), asked.files.end());
        report.config_hash = settings::hash(files);
        print_table(json_file, "{}", to_text(report));
        keep_json(out / "results.json", json_file, to_json(report));
        settings::write_file(out / "landings.csv", to_csv(report));
        draw(report, out / "regulate.png");
        print_table(json_file, "  {}, {}, {}\n", (out / "results.json").string(), (out / "landings.csv").string(), (out / "regulate.png").string());
        return report.all_met() ? 0 : 1;
    }

  private:
    [[nodiscard]] int characterise() const {
        const LandingSites sites = load_sites(config);
        antiskid::host::StopSignals signals;
        CharacteriseOptions options{.references = {}, .seed = seed, .threads = threads, .stop = &signals.stop()};
        constexpr int kFirst = 6;  // hundredths, as in the paper's study
        constexpr int kLast = 50;
        for (int k = kFirst; k <= kLast; k += 2) options.references.push_back(k / 100.0);
        settings::Progress progress(static_cast<std::int64_t>(characterising_stops(sites, options)), 0);
        options.on_stops = [&](std::size_t stops) { progress.show(static_cast<std::int64_t>(stops)); };
        const wear::Characterisation c = plant_sim::lab::characterise(sites, options);
        progress.finish();
        if (c.floor.rows.empty()) return kStopped;
        settings::write_file(characterised, wear::to_toml(c, fmt::format("rig-lab regulate --seed {} --characterise FILE", seed)));
        print_table(json_file, "{}: J_mu of {} references on {} surfaces\n", characterised.string(), c.floor.reference.size(), c.floor.rows.size());
        return 0;
    }
    [[nodiscard]] std::vector<regulation::Policy> policies(const wear::RegulationConfig& asked, const wear::WearPlan& plan,
                                                           const wear::Range& range) const {
        const double best = regulation::best_fixed(plan, asked.floor.reference, asked.tyre_share, range);
        std::vector<regulation::Policy> all{{"regulated", std::nullopt}};
        for (const double reference : fixed) {
            if (std::abs(reference - best) > 1e-6) all.push_back({fmt::format("fixed {:.2f}", reference), reference});
        }
        all.push_back({fmt::format("best fixed {:.2f}", best), best});
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
    verb->add_option("--seed", command->seed, "seed of every random draw")->check(CLI::NonNegativeNumber)->capture_default_str();
    settings::add_choice(*verb, "--mix", command->mix, {{"random", Mix::random}, {"balanced", Mix::balanced}},
                         "random: each landing any surface and maneuver; balanced: all equally often, in random order");
    verb->add_option("--missing", command->missing, "share of landings whose measurements are lost")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    verb->add_option("--brake-deviation", command->brake_deviation, "brakes differ in what they can still take by this share, standard deviation")
        ->check(CLI::Range(0.0, 0.5))
        ->capture_default_str();
    verb->add_option("--inspection", command->inspection, "landings between two inspections that tell a brake's true wear and life; 0: none")
        ->check(CLI::Range(0, 1'000'000))
        ->capture_default_str();
    verb->add_option("--surfaces", command->surfaces,
                     "seen before the plan's begin, with commas between, or all: others bound the references from their first landing on (default: "
                     "the regulation file's)");
    verb->add_flag("!--no-forecast", command->forecast, "where nobody inspects: take the brake's life from the configuration, not from its friction");
    verb->add_flag("!--no-floor-check", command->floor_check, "do not make every regulated landing again at both ends of the range");
    settings::existing_file(verb->add_option("--regulation", command->regulation_file, "plan and rules (default: CONFIG/regulation.toml)"));
    verb->add_option("--characterise", command->characterised, "only measure J_mu over reference and surface, and write the floor table to this file")
        ->type_name("FILE");
    settings::add_json(*verb, command->json_file, "results");
    settings::add_out(*verb, command->out, "directory for results.json, landings.csv, regulate.png");
    settings::add_config_directory(*verb, command->config);
    settings::add_threads(*verb, command->threads);
    verb->footer(
        "Examples:\n"
        "  rig-lab regulate\n"
        "  rig-lab regulate --lives 4 --mix balanced --out out/balanced\n"
        "  rig-lab regulate --brake-deviation 0.05 --inspection 0 --missing 0.1\n"
        "  rig-lab regulate --surfaces dry_asphalt,wet_asphalt\n"
        "  rig-lab regulate --characterise config/regulation_floor.toml\n"
        "Exit status: 0 both limits met in every life where that was feasible, and no stop beyond the floor; 1 not so; 2 mistake on the command line "
        "or in a configuration file; 130 stopped by Ctrl-C.");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim::lab
