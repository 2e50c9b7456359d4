#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/stop_signals.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/faults/explain.hpp"
#include "plant_sim/study/faults/fault_campaign.hpp"
#include "plant_sim/study/faults/report.hpp"
#include "plant_sim/study/robust/robust_campaign.hpp"
#include "plant_sim/study/trajectory.hpp"
#include "rig_bridge/pictures/stop_picture.hpp"
#include "rig_bridge/wear/on_threads.hpp"

namespace plant_sim::lab {

namespace {

constexpr const char* kFaultsFooter =
    "Leaves runs.csv (every run), results.json and matrix.png in OUT; --run leaves run-N.csv and run-N.png.\n"
    "docs/engineering/fault_campaign.md has the criteria.\n"
    "Examples:\n"
    "  rig-lab faults\n"
    "  rig-lab faults --signal wheel --kind delay --no-pictures\n"
    "  rig-lab faults --run 4711        one run again, with its course and picture\n"
    "  rig-lab faults --repetitions 1 --surfaces ice\n"
    "Exit status: 0 no run is UNSAFE; 1 some are, or a file could not be written; 2 mistake on the command line or in a file; 130 stopped by Ctrl-C.";

struct FaultsCommand {
    faults::FaultPlanOptions plan;
    std::string signal;
    std::string kind;
    std::optional<std::size_t> run;
    std::vector<std::size_t> explain;
    unsigned threads = wear::all_cores();
    std::filesystem::path out = "out/faults";
    std::string json_file;  ///< "-": standard output
    bool pictures = true;

    [[nodiscard]] int execute() const {
        const faults::FaultPlan campaign = faults::load_plan(plan);
        if (run) return repeat(campaign, *run);
        if (!explain.empty()) return say_why(campaign);
        antiskid::host::StopSignals signals;
        const std::vector<std::size_t> numbers = chosen(campaign);
        settings::Progress progress(static_cast<std::int64_t>(numbers.size()), 0);
        const std::vector<faults::JudgedRun> rows =
            faults::run_campaign(campaign, numbers, {.threads = threads, .stop = &signals.stop(), .progress = [&progress](std::size_t done) {
                                                         progress.show(static_cast<std::int64_t>(done));
                                                     }});
        progress.finish();
        if (rows.size() < numbers.size()) {
            fmt::print(stderr, "rig-lab: stopped after {} of {} runs; nothing is written\n", rows.size(), numbers.size());
            return signals.exit_status();
        }
        settings::write_file(out / "runs.csv", faults::to_csv(campaign, rows));
        write_json(out / "results.json", json_file, faults::to_json(campaign, rows));
        if (pictures) faults::draw_matrix(campaign, rows, out / "matrix.png");
        constexpr std::size_t kShown = 20;
        print_table(json_file, "{}  seed {}, configuration {}, version {}\nWritten to {}: runs.csv results.json{}\n",
                    faults::to_table(campaign, rows, kShown), campaign.seed, campaign.config_hash, campaign.version, out.string(),
                    pictures ? " matrix.png" : "");
        return std::any_of(rows.begin(), rows.end(),
                           [](const faults::JudgedRun& row) { return row.result.verdict.outcome == faults::Outcome::unsafe; })
                   ? 1
                   : 0;
    }

  private:
    [[nodiscard]] std::vector<std::size_t> chosen(const faults::FaultPlan& campaign) const {
        std::vector<std::size_t> numbers;
        for (std::size_t i = 0; i < campaign.runs(); ++i) {
            const faults::Pair what = campaign.at(i).fault.what;
            if ((signal.empty() || signal == name(what.signal)) && (kind.empty() || kind == name(what.kind))) numbers.push_back(i);
        }
        if (numbers.empty()) throw std::invalid_argument(fmt::format("--signal {} --kind {}: no such pair in the catalogue", signal, kind));
        return numbers;
    }
    [[nodiscard]] int repeat(const faults::FaultPlan& campaign, std::size_t number) const {
        const faults::Case c = case_of(campaign, "--run", number);
        study::Trajectory course;
        const faults::Result result = faults::run_one(campaign, c, faults::run_fault_free(campaign, c),
                                                      [&course](const faults::Period& p) { course.record(p.session, p.view, p.driver_mA); });
        settings::write_file(out / fmt::format("run-{}.csv", number), course.csv());
        const std::string what = faults::describe(campaign, c);
        if (pictures) {
            const study::ManeuverPlan& maneuver = campaign.maneuver;
            pictures::draw_stop(course.rows(), out / fmt::format("run-{}.png", number), what, maneuver.touchdown_s + maneuver.settle_s);
        }
        print_table(json_file, "{}\n{}\nWritten to {}\n", what, faults::describe(result), out.string());
        return result.verdict.outcome == faults::Outcome::unsafe ? 1 : 0;
    }
    [[nodiscard]] int say_why(const faults::FaultPlan& campaign) const {
        robust::RobustPlanOptions rigs;
        rigs.config = plan.config;
        const robust::Basis basis = robust::load_plan(rigs).basis;
        std::vector<std::optional<faults::Explanation>> found(explain.size());
        wear::run_jobs(threads, explain.size(),
                       [&](std::size_t i) { found[i] = faults::explain(campaign, case_of(campaign, "--explain", explain[i]), basis); });
        std::vector<faults::Explanation> explanations;
        explanations.reserve(found.size());
        for (const auto& one : found) explanations.push_back(*one);
        write_json(out / "explained.json", json_file, faults::to_json(campaign, explanations));
        print_table(json_file, "{}Written to {}: explained.json\n", faults::to_table(campaign, explanations), out.string());
        return 0;
    }
    [[nodiscard]] static faults::Case case_of(const faults::FaultPlan& campaign, const char* option, std::size_t number) {
        if (number >= campaign.runs()) throw std::invalid_argument(fmt::format("{} {}: expected 0 to {}", option, number, campaign.runs() - 1));
        return campaign.at(number);
    }
};

}  // namespace

LabVerb faults_verb(CLI::App& lab) {
    const auto command = std::make_shared<FaultsCommand>();
    CLI::App* verb =
        lab.add_subcommand("faults", "The fault campaign: every fault of every signal in every phase of a stop on four surfaces, against criteria.");
    constexpr std::size_t kMaxRepetitions = 1000;
    verb->add_option("--repetitions", command->plan.repetitions, "runs of each fault, phase and surface")
        ->check(CLI::Range(std::size_t{1}, kMaxRepetitions))
        ->capture_default_str();
    verb->add_option("--surfaces", command->plan.surfaces, "tables of surfaces.toml")->delimiter(',')->capture_default_str();
    verb->add_option("--maneuver", command->plan.maneuver, "table of maneuvers.toml")->capture_default_str();
    settings::one_of(verb->add_option("--signal", command->signal, "only faults of this one"),
                     {faults::kSignalNames.begin(), faults::kSignalNames.end()});
    settings::one_of(verb->add_option("--kind", command->kind, "only faults of this kind"), {faults::kKindNames.begin(), faults::kKindNames.end()})
        ->check(CLI::IsMember(std::vector<std::string>(faults::kKindNames.begin(), faults::kKindNames.end())));
    verb->add_option("--run", command->run, "this run alone, by its number in runs.csv; give seed, surfaces, maneuver and repetitions as then");
    verb->add_option("--explain", command->explain,
                     "these runs alone, each beside fault-free stops that are as long: which symptoms the controller's inputs show")
        ->delimiter(',');
    settings::add_seed(*verb, command->plan.seed);
    settings::add_threads(*verb, command->threads);
    settings::add_json(*verb, command->json_file, "results");
    settings::add_out(*verb, command->out, "directory of the results");
    settings::add_config_directory(*verb, command->plan.config);
    settings::add_no_pictures(*verb, command->pictures);
    verb->footer(kFaultsFooter);
    return {verb, [command] { return command->execute(); }};
}

}  // namespace plant_sim::lab
