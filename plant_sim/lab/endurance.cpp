#include <fmt/core.h>

#include <memory>
#include <optional>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/stop_signals.hpp"
#include "plant_sim/endurance/endurance_campaign.hpp"
#include "plant_sim/endurance/table_three.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/scenario/brake_options.hpp"

namespace plant_sim::lab {

namespace {

struct EnduranceCommand {
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path scenario;
    std::filesystem::path out;
    std::string json_file;  ///< "-": standard output
    std::int64_t maneuvers = 500;
    std::uint64_t seed = 1;
    BrakeOptions brake;
    std::filesystem::path wear_model;

    [[nodiscard]] int run() const {
        const auto file = scenario.empty() ? config / "scenarios" / "endurance.toml" : scenario;
        const endurance::EnduranceSetup setup = endurance::load_setup(file, config);
        const auto directory = out.empty() ? std::filesystem::path("out") / fmt::format("{}-{}", setup.scenario.name, seed) : out;
        settings::create_directories(directory);
        const double taken_J = brake.initial_energy_J(setup.scenario.rig.wear);
        if (!std::filesystem::exists(directory / "campaign.sqlite")) (void)brake.brake_of(setup.scenario.rig.wear, seed);  // refuses what contradicts
        antiskid::host::StopSignals signals;
        std::optional<settings::Progress> progress;
        const auto observe = [&progress](const rig::record::Summary& summary, std::int64_t planned) {
            if (!progress) progress.emplace(planned, summary.number);
            progress->show(summary.number);
        };
        const endurance::CampaignResult result = endurance::run_campaign(setup,
                                                                         {.maneuvers = maneuvers,
                                                                          .seed = seed,
                                                                          .ledger = directory / "campaign.sqlite",
                                                                          .wear_model = wear_model,
                                                                          .stop = &signals.stop(),
                                                                          .taken_J = taken_J,
                                                                          .by_model = brake.by_model ? std::optional(brake.rule) : std::nullopt,
                                                                          .brake_state = brake.state},
                                                                         observe);
        if (progress) progress->finish();
        if (result.earlier > 0)
            print_table(json_file, "{} maneuvers were in the ledger already; remove {} to begin anew\n", result.earlier, directory.string());
        report(setup, result, directory);
        if (const std::string beyond = extrapolation_notice(*result.brake); !beyond.empty()) fmt::print(stderr, "rig-lab: {}\n", beyond);
        if (result.aborted) {
            fmt::print(stderr, "rig-lab: maneuver {} was aborted: {}\n", result.last.number, result.last.outcome);
            return 1;
        }
        if (signals.stop().load()) return signals.exit_status();
        return 0;
    }

  private:
    void report(const endurance::EnduranceSetup& setup, const endurance::CampaignResult& result, const std::filesystem::path& directory) const {
        std::optional<endurance::TableThree> printed;
        if (setup.scenario.endurance()) printed = endurance::printed_table(config);
        const auto& done = result.finished;
        print_table(json_file, "{}: {} maneuvers finished, seed {}\n", setup.scenario.title, done.size(), seed);
        if (!done.empty()) {
            print_table(json_file, "{}", endurance::to_text(endurance::measured_table(done), printed));
            print_table(json_file, "  brake energy {:.1f} MJ, mean friction {:.4f} in the first, {:.4f} in the last\n",
                        done.back().cumulative_energy_J * 1e-6, done.front().figures.mean_friction, done.back().figures.mean_friction);
        }
        if (!wear_model.empty())
            print_table(json_file, "  brake {}{}\n", name(result.health.state),
                        result.health.reason.empty() ? ", judged by brakes " + result.model_origin : ": " + result.health.reason);
        const auto json = directory / "table.json";
        write_json(json, json_file,
                   endurance::to_json({.scenario = setup.scenario.name, .config_hash = setup.config_hash, .version = ANTISKID_VERSION, .seed = seed},
                                      done, printed));
        print_table(json_file, "  {}, {}\n", (directory / "campaign.sqlite").string(), json.string());
    }
};

}  // namespace

LabVerb endurance_verb(CLI::App& lab) {
    const auto command = std::make_shared<EnduranceCommand>();
    CLI::App* verb = lab.add_subcommand("endurance",
                                        "A campaign of identical maneuvers until the brake is worn: sequencer, controller, PLC, plant and wear in "
                                        "one process. Leaves campaign.sqlite and table.json; a campaign that was stopped goes on.");
    constexpr std::int64_t kMax = 1'000'000;
    verb->add_option("--maneuvers", command->maneuvers, "how many in all")->check(CLI::Range(std::int64_t{1}, kMax))->capture_default_str();
    settings::add_seed(*verb, command->seed)->check(CLI::Range(std::uint64_t{0}, std::uint64_t{INT64_MAX}));
    settings::existing_file(verb->add_option("--scenario", command->scenario, "scenario file (default: CONFIG/scenarios/endurance.toml)"));
    settings::add_json(*verb, command->json_file, "table");
    settings::add_out(*verb, command->out, "directory of the results (default: out/SCENARIO-SEED)");
    command->brake.add_to(*verb);
    settings::existing_file(
        verb->add_option("--wear-model", command->wear_model, "judge the brake after each maneuver by this population.json or model.json of `wear`"));
    settings::add_config_directory(*verb, command->config);
    verb->footer(
        "Examples:\n"
        "  rig-lab endurance --maneuvers 500\n"
        "  rig-lab endurance --maneuvers 20 --seed 7 --out /tmp/campaign\n"
        "  rig-lab endurance --maneuvers 20 --brake 300 --brake-state brake.json\n"
        "  rig-lab endurance --scenario config/scenarios/heavy.toml --maneuvers 10\n"
        "Exit status: 0 all maneuvers finished; 1 one was aborted, or the ledger could not be written; 2 mistake on the command line or in a "
        "configuration file; 130 stopped by Ctrl-C, goes on when started again.");
    return {verb, [command] {
                try {
                    return command->run();
                } catch (const rig::record::LedgerError& e) {
                    fmt::print(stderr, "rig-lab: {}\n", e.what());
                    return 1;
                }
            }};
}

}  // namespace plant_sim::lab
