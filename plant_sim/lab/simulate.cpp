#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "firmware/host/settings/progress.hpp"
#include "firmware/host/stop_signals.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/simulation/disk_campaign.hpp"

namespace plant_sim::lab {

namespace {

struct SimulatedDiskCommand {
    std::filesystem::path out = "out/simulate";
    std::string json_file;  ///< "-": standard output
    std::int64_t campaigns = 1000;
    std::uint64_t seed = 1;
    bool trace = false;

    [[nodiscard]] int run() const {
        antiskid::host::StopSignals signals;
        settings::Progress progress(campaigns, 0, "campaigns");
        simulation::CampaignOutcome sum;
        nlohmann::ordered_json failed = nlohmann::ordered_json::array();
        simulation::DiskTrace sink;
        if (trace) sink = [](const std::string& line) { fmt::print(stderr, "{}\n", line); };
        std::int64_t done = 0;
        for (; done < campaigns && !signals.stop().load(); ++done) {
            const std::uint64_t its = seed + static_cast<std::uint64_t>(done);
            const simulation::CampaignOutcome outcome = simulation::run_disk_campaign(its, {}, sink);
            if (!outcome.violations.empty()) failed.push_back({{"seed", its}, {"violations", outcome.violations}});
            sum += outcome;
            if (!trace) progress.show(done + 1);
        }
        if (!trace) progress.finish();
        nlohmann::ordered_json result{{"seed", seed},
                                      {"campaigns", done},
                                      {"maneuvers", sum.maneuvers},
                                      {"starts", sum.starts},
                                      {"operations", sum.operations},
                                      {"damaged_logs_named", sum.damaged},
                                      {"ended_by_refusals", sum.refusals},
                                      {"failed", failed}};
        print_table(json_file, "{} campaigns, seeds {} to {}: {} maneuvers begun, {} starts of the program, {} operations of the disk\n", done, seed,
                    seed + static_cast<std::uint64_t>(done) - 1, sum.maneuvers, sum.starts, sum.operations);
        for (std::size_t i = 0; i < sum.struck.size(); ++i) {
            print_table(json_file, "  {:12} {:8}\n", simulation::kDiskFaultNames.at(i), sum.struck.at(i));
            result["struck"][std::string(simulation::kDiskFaultNames.at(i))] = sum.struck.at(i);
        }
        for (const auto& one : failed)
            print_table(json_file, "  VIOLATED: {}\n    rig-lab simulate --seed {} --campaigns 1 --trace\n", one["violations"][0].get<std::string>(),
                        one["seed"].get<std::uint64_t>());
        if (failed.empty()) print_table(json_file, "  nothing acknowledged was lost or counted twice\n");
        keep_json(out / "results.json", json_file, result.dump(2) + "\n");
        if (signals.stop().load()) return signals.number() == SIGINT ? 130 : 1;
        return failed.empty() ? 0 : 1;
    }
};

}  // namespace

LabVerb simulate_verb(CLI::App& lab) {
    const auto command = std::make_shared<SimulatedDiskCommand>();
    CLI::App* verb = lab.add_subcommand("simulate",
                                        "Campaigns by the real recorder, summary and ledger on a simulated disk that loses its power, fills up and "
                                        "refuses: is anything lost or counted twice?");
    verb->add_option("--campaigns", command->campaigns, "how many")->check(CLI::Range(1, 1'000'000'000))->capture_default_str();
    verb->add_option("--seed", command->seed, "of the first campaign; each next one has the next")
        ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{INT64_MAX}))
        ->capture_default_str();
    verb->add_flag("--trace", command->trace, "each operation of the disk and what the programs say of it, on standard error");
    settings::add_json(*verb, command->json_file, "result");
    settings::add_out(*verb, command->out, "directory of the result");
    verb->footer(
        "Maneuvers are made frames. Not in it: controller, rig, sequencer, network and clock; the recorder's thread.\n"
        "Leaves results.json in OUT.\n"
        "Examples:\n"
        "  rig-lab simulate --campaigns 10000\n"
        "  rig-lab simulate --seed 17 --campaigns 1 --trace\n"
        "Exit status: 0 nothing was lost; 1 something was; 2 mistake on the command line; 130 stopped by Ctrl-C.");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim::lab
