#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/stop_signals.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/sweep/summary.hpp"
#include "plant_sim/study/sweep/sweep_plan.hpp"
#include "plant_sim/study/sweep/together.hpp"

namespace plant_sim::lab {

namespace {

constexpr const char* kFooter =
    "Leaves stops.csv (every stop), results.json, fig13.png and fig14.png in OUT.\n"
    "Ctrl-C leaves what is finished in stops.part, from which the same command goes on.\n"
    "Examples:\n"
    "  rig-lab sweep\n"
    "  rig-lab sweep --references 0.24 --landings 20 --no-pictures\n"
    "  mpirun -n 4 rig-lab sweep        the same bytes\n"
    "Exit status: 0 what Section VI says holds; 1 some of it does not, or a file could not be written; 2 mistake on the command line or in a file; "
    "130 stopped by Ctrl-C.";

/// "0.06:0.50:0.01", or values with commas between.
std::vector<double> parse_references(const std::string& text) {
    const auto reject = [&text]() -> std::vector<double> {
        throw std::invalid_argument("--references '" + text +
                                    "': expected FIRST:LAST:STEP or values with commas between, increasing, from 0.01 to 0.5");
    };
    const char separator = text.find(':') == std::string::npos ? ',' : ':';
    std::vector<double> values;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find(separator, at), text.size());
        std::size_t used = 0;
        double value = 0.0;
        try {
            value = std::stod(text.substr(at, end - at), &used);
        } catch (const std::logic_error&) {
            return reject();
        }
        if (used != end - at || !std::isfinite(value)) return reject();
        values.push_back(value);
        at = end + 1;
    }
    if (separator == ':') {
        if (values.size() != 3 || values[2] < 1e-4 || values[1] < values[0]) return reject();
        const double first = values[0];
        const double step = values[2];
        const auto steps = static_cast<std::size_t>(std::floor((values[1] - first) / step + 1e-6));
        values.clear();
        for (std::size_t i = 0; i <= steps; ++i) values.push_back(first + static_cast<double>(i) * step);
    }
    const auto references = sweep::in_whole_steps(values);
    return references ? *references : reject();
}

struct SweepCommand {
    sweep::SweepPlanOptions plan;
    std::string references;
    unsigned threads = 0;
    std::filesystem::path out = "out/sweep";
    std::string json_file;  ///< "-": standard output
    bool pictures = true;

    [[nodiscard]] int run() {
        if (!references.empty()) plan.references = parse_references(references);
        return in_team([this](study::team::Team& team) { return run_with(team); });
    }

  private:
    [[nodiscard]] int run_with(study::team::Team& team) const {
        antiskid::host::StopSignals signals;
        const sweep::SweepPlan study = sweep::load_plan(plan);
        std::optional<settings::Progress> progress;
        sweep::Work work{.part = out / "stops.part", .stop = &signals.stop()};
        work.threads = threads_in(team, threads);
        work.progress = [&progress](std::size_t done, std::size_t all, std::size_t before) {
            if (!progress) progress.emplace(static_cast<std::int64_t>(all), static_cast<std::int64_t>(before));
            progress->show(static_cast<std::int64_t>(done));
        };
        const std::vector<sweep::SweptStop> rows = sweep::run_together(study, work, team);
        if (progress) progress->finish();
        if (team.rank() != 0) return 0;
        if (rows.size() < study.stops()) {
            fmt::print(stderr, "rig-lab: {} of {} stops are in {}; the same command goes on\n", rows.size(), study.stops(), work.part.string());
            return signals.exit_status();
        }
        const sweep::Identity identity = sweep::identity_of(study);
        const sweep::Summary summary = sweep::summarised(identity, rows);
        settings::write_file(out / "stops.csv", sweep::to_csv(identity, rows));
        write_json(out / "results.json", json_file, sweep::to_json(summary));
        if (pictures) {
            sweep::draw_fig13(summary, out / "fig13.png");
            sweep::draw_fig14(summary, out / "fig14.png");
        }
        print_table(json_file, "{}  seed {}, configuration {}, version {}\nWritten to {}: stops.csv results.json{}\n", sweep::to_table(summary),
                    identity.seed, identity.config_hash, identity.version, out.string(), pictures ? " fig13.png fig14.png" : "");
        std::filesystem::remove(work.part);
        return summary.passed() ? 0 : 1;
    }
};

}  // namespace

LabVerb sweep_verb(CLI::App& lab) {
    const auto command = std::make_shared<SweepCommand>();
    CLI::App* verb = lab.add_subcommand("sweep",
                                        "The set-point study of Section VI: landings drawn at random over surfaces, maneuvers and wear of the brake, "
                                        "each with every slip reference and by the threshold law. Fig. 13 and 14.");
    constexpr std::size_t kMaxLandings = 100'000;
    verb->add_option("--references", command->references, "slip references, FIRST:LAST:STEP or values with commas between (default: 0.06:0.50:0.01)");
    verb->add_option("--landings", command->plan.landings, "how many are drawn; each reference has the same")
        ->check(CLI::Range(std::size_t{1}, kMaxLandings))
        ->capture_default_str();
    verb->add_flag("!--no-threshold", command->plan.threshold, "without the threshold law");
    settings::add_seed(*verb, command->plan.seed);
    settings::add_threads(*verb, command->threads, "all cores; 1 for each process of mpirun");
    settings::add_json(*verb, command->json_file, "results");
    settings::add_out(*verb, command->out, "directory of the results");
    settings::add_config_directory(*verb, command->plan.config);
    settings::add_no_pictures(*verb, command->pictures);
    verb->footer(kFooter);
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim::lab
