#include <fmt/core.h>
#include <fmt/ranges.h>
#include <malloc.h>

#include <functional>
#include <memory>

#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/stop_signals.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/simulation/cell_campaign.hpp"
#include "plant_sim/simulation/disk_campaign.hpp"

namespace plant_sim::lab {

namespace {

struct FailingCommand {
    using Sink = std::function<void(const std::string&)>;

    std::filesystem::path config = settings::config_directory();
    std::filesystem::path out = "out/simulate";
    std::string json_file;  ///< "-": standard output
    std::string failing = "disk";
    std::int64_t campaigns = 1000;
    std::uint64_t seed = 1;
    bool trace = false;

    [[nodiscard]] int run() const {
        if (failing == "cell") return run_cell();
        return run(simulation::CampaignOutcome{}, [](std::uint64_t its, const Sink& sink) { return simulation::run_disk_campaign(its, {}, sink); });
    }

  private:
    [[nodiscard]] int run_cell() const {
        const simulation::CellSetup setup = simulation::load_cell_setup(config);
        return run(simulation::CellOutcome{}, [&](std::uint64_t its, const Sink& sink) {
            const auto faults = simulation::faults_of(its);
            simulation::CellOutcome outcome = simulation::run_cell_campaign(setup, its, faults, sink);
            if (outcome.violations.empty()) return outcome;
            for (const simulation::PlannedFault& fault : simulation::fewest_faults(setup, its, faults))
                outcome.violations.push_back("with this alone: " + simulation::text(fault));
            return outcome;
        });
    }

    /// A campaign's disk has files of megabytes. Given back after each and fetched again page by page, they cost a fifth of the time.
    static void keep_memory() {
        constexpr int kMost_bytes = 32 << 20U;
        static_cast<void>(mallopt(M_MMAP_THRESHOLD, kMost_bytes));
        static_cast<void>(mallopt(M_TRIM_THRESHOLD, 16 * kMost_bytes));
        static_cast<void>(mallopt(M_TOP_PAD, kMost_bytes));
    }

    template <typename Outcome, typename Campaign>
    [[nodiscard]] int run(Outcome sum, const Campaign& campaign) const {
        keep_memory();
        antiskid::host::StopSignals signals;
        settings::Progress progress(campaigns, 0, "campaigns");
        settings::Json failed = settings::Json::array();
        Sink sink;
        if (trace) sink = [](const std::string& line) { fmt::print(stderr, "{}\n", line); };
        std::int64_t done = 0;
        for (; done < campaigns && !signals.stop().load(); ++done) {
            const std::uint64_t its = seed + static_cast<std::uint64_t>(done);
            const Outcome outcome = campaign(its, sink);
            if (!outcome.violations.empty()) failed.push_back({{"seed", its}, {"violations", outcome.violations}});
            sum += outcome;
            if (!trace) progress.show(done + 1);
        }
        if (!trace) progress.finish();
        settings::Json result{{"failing", failing}, {"seed", seed}, {"campaigns", done}};
        print_table(json_file, "{} campaigns, seeds {} to {}: ", done, seed, seed + static_cast<std::uint64_t>(done) - 1);
        show(sum, result);
        result["failed"] = failed;
        for (const auto& one : failed) {
            print_table(json_file, "  VIOLATED: {}\n", fmt::join(one["violations"].template get<std::vector<std::string>>(), "\n    "));
            print_table(json_file, "    rig-lab simulate --failing {} --seed {} --campaigns 1 --trace\n", failing,
                        one["seed"].template get<std::uint64_t>());
        }
        if (failed.empty()) print_table(json_file, "  everything held\n");
        write_json(out / "results.json", json_file, settings::json_page(result));
        if (signals.stop().load()) return signals.exit_status();
        return failed.empty() ? 0 : 1;
    }

    void show(const simulation::CampaignOutcome& sum, settings::Json& result) const {
        result["maneuvers"] = sum.maneuvers;
        result["starts"] = sum.starts;
        result["operations"] = sum.operations;
        result["damaged_logs_named"] = sum.damaged;
        result["ended_by_refusals"] = sum.refusals;
        print_table(json_file, "{} maneuvers begun, {} starts of the program, {} operations of the disk\n", sum.maneuvers, sum.starts,
                    sum.operations);
        for (std::size_t i = 0; i < sum.fault_counts.size(); ++i) count(simulation::kDiskFaultNames.at(i), sum.fault_counts.at(i), result["struck"]);
    }

    void show(const simulation::CellOutcome& sum, settings::Json& result) const {
        result["attempts"] = sum.attempts;
        result["finished"] = sum.finished;
        result["starts"] = sum.starts;
        result["ended_by_refusals"] = sum.refusals;
        result["operations"] = sum.operations;
        result["damaged_logs_named"] = sum.damaged;
        result["simulated_s"] = sum.simulated_s;
        result["frames_struck"] = sum.faulted_frames;
        result["requests_struck"] = sum.faulted_requests;
        print_table(json_file,
                    "{} maneuvers finished in {} attempts, {} starts of the bridge, {:.2f} h simulated; {} frames and {} requests struck, {} "
                    "operations of the disk\n",
                    sum.finished, sum.attempts, sum.starts, sum.simulated_s / 3600.0, sum.faulted_frames, sum.faulted_requests, sum.operations);
        for (std::size_t i = 0; i < sum.begun.size(); ++i) count(simulation::kCellFaultNames.at(i), sum.begun.at(i), result["faults"]);
        print_table(json_file, "  the disk:\n");
        for (std::size_t i = 0; i < sum.disk_fault_counts.size(); ++i)
            count(simulation::kDiskFaultNames.at(i), sum.disk_fault_counts.at(i), result["struck"]);
        print_table(json_file, "  aborts:\n");
        for (const auto& [cause, times] : sum.aborts) count(cause, times, result["aborts"]);
    }

    template <typename Count>
    void count(std::string_view name, Count times, settings::Json& into) const {
        print_table(json_file, "  {:18} {:8}\n", name, times);
        into[std::string(name)] = times;
    }
};

}  // namespace

LabVerb simulate_verb(CLI::App& lab) {
    const auto command = std::make_shared<FailingCommand>();
    CLI::App* verb = lab.add_subcommand("simulate",
                                        "Campaigns whose disk, or whose bus, PLC, programs and interlocks fail, in one process on a simulated clock: "
                                        "does what must hold?");
    settings::one_of(
        verb->add_option("--failing", command->failing,
                         "disk: recorder, summary and ledger where the power is cut and the disk is full or refuses; cell: controller, rig "
                         "and bridge on such a disk, their frames, the PLC's requests, interlocks and wall clock"),
        {"disk", "cell"})
        ->capture_default_str();
    verb->add_option("--campaigns", command->campaigns, "how many")->check(CLI::Range(1, 1'000'000'000))->capture_default_str();
    verb->add_option("--seed", command->seed, "of the first campaign; each next one has the next")
        ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{INT64_MAX}))
        ->capture_default_str();
    verb->add_flag("--trace", command->trace, "each operation of the disk, or what happens in the cell, on standard error");
    settings::add_json(*verb, command->json_file, "result");
    settings::add_out(*verb, command->out, "directory of the result");
    settings::add_config_directory(*verb, command->config);
    verb->footer(
        "disk: maneuvers are made frames. cell: the whole system. Not in either are threads. A campaign of the cell in which something does not "
        "hold\n"
        "is made smaller: the faults that are needed, and for how long.\n"
        "Leaves results.json in OUT.\n"
        "Examples:\n"
        "  rig-lab simulate --campaigns 10000\n"
        "  rig-lab simulate --failing cell --campaigns 100\n"
        "  rig-lab simulate --seed 17 --campaigns 1 --trace\n"
        "Exit status: 0 everything held; 1 something did not; 2 mistake on the command line; 130 stopped by Ctrl-C.");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim::lab
