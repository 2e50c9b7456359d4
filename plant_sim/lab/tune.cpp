#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>
#include <stdexcept>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/lab/tune_law.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/margins/margins_input.hpp"
#include "plant_sim/study/margins/tune.hpp"
#include "rig_bridge/wear/on_threads.hpp"

namespace plant_sim::lab {

namespace {

namespace margins = study::margins;
using settings::Json;

Json to_json(const margins::WorstScore& w) {
    return {{"score", w.value}, {"cells", w.counted}, {"unstable", w.unstable}, {"met", w.met}};
}

/// Where the reference, held at every speed, leaves no controller enough margin: a row for each scenario that has such cells.
std::string infeasible_table(const margins::MarginsInput& input, const margins::StudyOptions& options, Json& rows) {
    constexpr int kSpeeds = 200;
    auto table = settings::TextTable::markdown(
        "surface|maneuver|infeasible at and below (m/s):.1f|unstable pole there (rad/s):.0f|largest PM (deg):.1f|largest gain range (dB):.1f|at "
        "drop-out: pole:.0f|PM:.1f|range:.1f");
    rows = Json::array();
    const double period_s = static_cast<double>(input.scenarios.front().controller.period_s);
    for (const margins::StopConditions& s : input.cases) {
        const auto speeds = margins::speed_grid(s.rig.brake_on_mps, s.drop_out_mps, kSpeeds);
        const auto pole = [&](double v) {
            return margins::operating_point(s.rig, v, options.slip_reference).wheel_pole_radps(margins::Linearisation::full);
        };
        const auto at = std::find_if(speeds.begin(), speeds.end(),
                                     [&](double v) { return !margins::limits(pole(v), s.rig.valve.delay_s, period_s).allow(options.requirement); });
        if (at == speeds.end()) continue;
        const auto there = margins::limits(pole(*at), s.rig.valve.delay_s, period_s);
        const auto last = margins::limits(pole(speeds.back()), s.rig.valve.delay_s, period_s);
        table.add(s.surface, s.maneuver, *at, -pole(*at), there.phase_deg, there.gain_range_dB, -pole(speeds.back()), last.phase_deg,
                  last.gain_range_dB);
        rows.push_back({{"surface", s.surface},
                        {"maneuver", s.maneuver},
                        {"infeasible_below_mps", *at},
                        {"pole_radps", -pole(*at)},
                        {"limit_phase_margin_deg", there.phase_deg},
                        {"limit_gain_range_dB", there.gain_range_dB}});
    }
    if (rows.empty()) table.add("none", "", "", "", "", "", "", "", "");
    return fmt::format("Slip {:.2f} held at every speed: where no controller can have {:.0f} deg and {:.0f} dB up and down\n\n{}",
                       options.slip_reference, options.requirement.phase_deg, options.requirement.gain_dB, table.text());
}

/// Where the shipped law has too little upward margin whatever its derivative gains and estimator: a row for each scenario.
std::string creep_table(const margins::MarginsInput& input, const margins::StudyOptions& options, Json& rows) {
    constexpr int kSpeeds = 200;
    const antiskid::control::SlipConfig& law = input.scenarios.front().controller.slip;
    const auto k_p = static_cast<double>(law.k_p_per_s), k_pole = static_cast<double>(law.k_pole);
    auto table = settings::TextTable::markdown(
        "surface|maneuver|at and below (m/s):.1f|at drop-out: stable pole (rad/s):.0f|upward margin (dB):.1f|k_pole that would have it:.2f");
    rows = Json::array();
    for (const margins::StopConditions& s : input.cases) {
        const auto pole = [&](double v) { return options.equilibrium(s.rig, law, v).wheel_pole_radps(margins::Linearisation::full); };
        const auto speeds = margins::speed_grid(s.rig.brake_on_mps, s.drop_out_mps, kSpeeds);
        const auto at = std::find_if(speeds.begin(), speeds.end(),
                                     [&](double v) { return margins::creep_margin_dB(pole(v), k_pole, k_p) < options.requirement.gain_dB; });
        if (at == speeds.end()) continue;
        const double last = pole(speeds.back());
        const double margin_dB = margins::creep_margin_dB(last, k_pole, k_p);
        const double enough = 1.0 - std::pow(10.0, -options.requirement.gain_dB / 20.0) - k_p / last;
        table.add(s.surface, s.maneuver, *at, last, margin_dB, enough);
        rows.push_back({{"surface", s.surface},
                        {"maneuver", s.maneuver},
                        {"below_mps", *at},
                        {"pole_at_drop_out_radps", last},
                        {"upward_margin_dB", margin_dB},
                        {"k_pole_that_would_have_it", enough}});
    }
    if (rows.empty()) table.add("none", "", "", "", "", "");
    return fmt::format("Where the shipped law cannot have {:.0f} dB upwards in the brake's gain with its k_p and k_pole\n\n{}",
                       options.requirement.gain_dB, table.text());
}

/// The paper's PID, by its margins in all cells that are feasible at all.
void tune_pid(const margins::MarginsInput& input, const margins::StudyOptions& options, const margins::SearchOptions& search,
              const std::string& json_file, Json& json) {
    const antiskid::control::Config& controller = input.scenarios.front().controller;
    const auto cells = margins::tuning_cells(input.cases, controller, options);
    const auto judged = [&](const std::vector<double>& x) {
        return margins::pid_score(margins::with(input.settings.pid, x), input.cases, cells, options.requirement);
    };
    const auto parameters = margins::pid_parameters(input.settings.pid);
    const auto found = margins::search(
        parameters, [&](const std::vector<double>& x, double) { return judged(x).value; }, search, settings::step_progress("gains judged"));
    std::vector<double> start;
    std::transform(parameters.begin(), parameters.end(), std::back_inserter(start), [](const margins::Parameter& k) { return k.start.value(); });
    auto table = settings::TextTable::markdown("|shipped:.4g|tuned:.4g");
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        table.add(parameters[i].name, start[i], found.values[i]);
        json["shipped"][parameters[i].name] = start[i];
        json["tuned"][parameters[i].name] = found.values[i];
    }
    const auto before = judged(start), after = judged(found.values);
    table.add("score", fmt::format("{:.3f}", before.value), fmt::format("{:.3f}", after.value));
    table.add(fmt::format("cells that meet {:.0f} deg and {:.0f} dB", options.requirement.phase_deg, options.requirement.gain_dB),
              std::to_string(before.met), std::to_string(after.met));
    table.add("unstable cells", std::to_string(before.unstable), std::to_string(after.unstable));
    print_table(json_file, "PID on measured slip: least of margins over required, worst of {} cells that are feasible at all\n\n{}", cells.size(),
                table.text());
    json["evaluations"] = found.evaluations;
    json["shipped"]["margins"] = to_json(before);
    json["tuned"]["margins"] = to_json(after);
}

struct TuneCommand {
    StopOptions scenario;
    margins::StudyOptions options;
    margins::SearchOptions search;
    std::optional<std::uint64_t> seed;
    std::optional<int> speeds, population, generations;
    std::optional<double> floor;
    std::string loop = "pid";
    bool constant_slip = false;
    bool check = false;
    std::filesystem::path out = "out/tune";
    std::string json_file;  ///< "-": standard output
    std::vector<std::filesystem::path> write;

    int run() {
        const bool law = loop == "law";
        if (!law && (check || !write.empty())) throw std::invalid_argument("--check and --write need --loop law");
        if (check && !write.empty()) throw std::invalid_argument("--check finds nothing to --write");
        scenario.seed = seed.value_or(1);
        margins::MarginsInput input = margins::load_margins_input(scenario);
        if (floor) input.settings.law.stops.mean_j_mu = *floor;
        settings::create_directories(out);  // refused now, not when the search is over
        options.slip_reference = scenario.slip;
        options.speeds = speeds.value_or(law ? 8 : 4);
        options.low_speed_fall = !constant_slip;
        options.requirement = input.settings.requirement;
        const unsigned threads = search.threads;
        if (law) search = input.settings.law.options;
        search.threads = threads > 0 ? threads : wear::all_cores();
        search.seed = seed.value_or(search.seed);
        search.population = population.value_or(search.population);
        search.generations = generations.value_or(search.generations);

        Json json{{"study", "tune"},
                  {"loop", loop},
                  {"config_hash", input.config_hash},
                  {"version", ANTISKID_VERSION},
                  {"seed", search.seed},
                  {"slip_reference", options.slip_reference}};
        int status = 0;
        if (law)
            status = tune_law({scenario, options, search, check, out, write, json_file}, input, json);
        else
            tune_pid(input, options, search, json_file, json);
        Json infeasible, creeping;
        const std::string table = infeasible_table(input, options, infeasible);
        print_table(json_file, "\n{}\n{}", table, creep_table(input, options, creeping));
        json["infeasible_at_constant_slip"] = infeasible;
        json["creeping"] = creeping;
        write_json(out / "results.json", json_file, settings::json_page(json));
        print_table(json_file, "Written to {}: results.json{}\n", out.string(), law && !check ? " slip.toml" : "");
        return status;
    }
};

}  // namespace

LabVerb tune_verb(CLI::App& lab) {
    const auto command = std::make_shared<TuneCommand>();
    CLI::App* verb =
        lab.add_subcommand("tune", "Gains with the largest worst margin over all surfaces, maneuvers and speeds; what no controller can have.");
    settings::one_of(verb->add_option("--loop", command->loop, "pid: the paper's, by its margins; law: the shipped one, by margins and stops"),
                     {"pid", "law"})
        ->capture_default_str();
    verb->add_option("--slip", command->scenario.slip, "slip reference")->check(CLI::Range(0.01, 0.5))->capture_default_str();
    verb->add_option("--speeds", command->speeds, "speeds from brake-on to drop-out (default: pid 4, law 8)")->check(CLI::Range(2, 50));
    verb->add_flag("--constant-slip", command->constant_slip, "the reference does not fall at low speed");
    verb->add_flag("--check", command->check, "law: no search; exit status 1 unless the stops of the shipped gains are what is asked");
    settings::existing_file(verb->add_option("--write", command->write, "law: controller files that get the gains in place of theirs"));
    verb->add_option("--floor", command->floor, "law: least mean J_mu over all stops (default: margins.toml's)")->check(CLI::Range(0.0, 1.0));
    verb->add_option("--population", command->population, "of the search (default: pid 16, law margins.toml's)")->check(CLI::Range(4, 1000));
    verb->add_option("--generations", command->generations, "of the search (default: pid 25, law margins.toml's)")->check(CLI::Range(0, 10000));
    verb->add_option("--seed", command->seed, "of the search, and of every sensor (default: 1; law: margins.toml's, sensors 1)");
    settings::add_threads(*verb, command->search.threads);
    settings::add_config_directory(*verb, command->scenario.config);
    settings::add_json(*verb, command->json_file, "results");
    settings::add_out(*verb, command->out, "directory of results.json and, for the law, slip.toml");
    verb->footer(
        "Examples:\n"
        "  rig-lab tune\n"
        "  rig-lab tune --loop law --write config/controller.toml --write config/controller_endurance.toml\n"
        "  rig-lab tune --loop law --check\n"
        "Exit status: 0; 1 --check: the gains are not what is asked; 2 mistake on the command line or in a file.");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim::lab
