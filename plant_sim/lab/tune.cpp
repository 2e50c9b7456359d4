#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "plant_sim/lab/margins_input.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/in_process.hpp"
#include "plant_sim/study/margins/law_loop.hpp"
#include "plant_sim/study/margins/tune.hpp"

namespace plant_sim {

namespace {

namespace margins = study::margins;
using nlohmann::ordered_json;

/// What a controller does in closed loop over all scenarios.
struct Acceptance {
    double j_mu = 0.0;  ///< mean
    double longest_lock_s = 0.0;
    double least_tracked = 1.0;
    bool faults = false;

    [[nodiscard]] bool holds(double floor) const {
        return j_mu >= floor && longest_lock_s <= 0.050 && least_tracked >= 0.95 && !faults;
    }
};

Acceptance accept(const MarginsInput& input, const antiskid::control::Config& controller) {
    Acceptance a;
    for (const Scenario& s : input.scenarios) {
        const auto run =
            study::run_in_process(controller, s.layout, s.plant.rig, s.session, study::Link::rounded);
        a.j_mu += run.figures.j_mu / static_cast<double>(input.scenarios.size());
        a.longest_lock_s = std::max(a.longest_lock_s, run.figures.longest_lock_s);
        a.least_tracked = std::min(a.least_tracked, run.figures.tracked_share);
        a.faults = a.faults || !run.faults.empty();
    }
    return a;
}

ordered_json to_json(const Acceptance& a) {
    return {{"mean_j_mu", a.j_mu},
            {"longest_lock_s", a.longest_lock_s},
            {"least_tracked_share", a.least_tracked}};
}
ordered_json to_json(const margins::WorstScore& w) {
    return {{"score", w.value}, {"cells", w.counted}, {"unstable", w.unstable}, {"met", w.met}};
}

/// Where the reference, held at every speed, leaves no controller enough margin: a row for each scenario that has such cells.
std::string infeasible_table(const MarginsInput& input, const margins::StudyOptions& options,
                             ordered_json& rows) {
    constexpr int kSpeeds = 200;
    std::string t = fmt::format(
        "Slip {:.2f} held at every speed: where no controller can have {:.0f} deg and {:.0f} dB up and "
        "down\n\n"
        "| surface | maneuver | infeasible at and below (m/s) | unstable pole there (rad/s) | largest PM "
        "(deg) | "
        "largest gain range (dB) | at drop-out: pole | PM | range |\n|---|---|---|---|---|---|---|---|---|\n",
        options.slip_reference, options.requirement.phase_deg, options.requirement.gain_dB);
    rows = ordered_json::array();
    const double period_s = static_cast<double>(input.scenarios.front().controller.period_s);
    for (const margins::Scenario& s : input.cases) {
        const auto speeds = margins::speed_grid(s.rig.brake_on_mps, s.drop_out_mps, kSpeeds);
        const auto pole = [&](double v) {
            return margins::operating_point(s.rig, v, options.slip_reference)
                .wheel_pole_radps(margins::Linearisation::full);
        };
        const auto at = std::find_if(speeds.begin(), speeds.end(), [&](double v) {
            return !margins::limits(pole(v), s.rig.valve.delay_s, period_s).allow(options.requirement);
        });
        if (at == speeds.end()) continue;
        const auto there = margins::limits(pole(*at), s.rig.valve.delay_s, period_s);
        const auto last = margins::limits(pole(speeds.back()), s.rig.valve.delay_s, period_s);
        fmt::format_to(std::back_inserter(t),
                       "| {} | {} | {:.1f} | {:.0f} | {:.1f} | {:.1f} | {:.0f} | {:.1f} | {:.1f} |\n",
                       s.surface, s.maneuver, *at, -pole(*at), there.phase_deg, there.gain_range_dB,
                       -pole(speeds.back()), last.phase_deg, last.gain_range_dB);
        rows.push_back({{"surface", s.surface},
                        {"maneuver", s.maneuver},
                        {"infeasible_below_mps", *at},
                        {"pole_radps", -pole(*at)},
                        {"limit_phase_margin_deg", there.phase_deg},
                        {"limit_gain_range_dB", there.gain_range_dB}});
    }
    if (rows.empty()) t += "| none | | | | | | | | |\n";
    return t;
}

/// Where the shipped law has too little upward margin whatever its derivative gains and estimator: a row for each scenario.
std::string creep_table(const MarginsInput& input, const margins::StudyOptions& options, ordered_json& rows) {
    constexpr int kSpeeds = 200;
    const antiskid::control::SlipConfig& law = input.scenarios.front().controller.slip;
    const auto k_p = static_cast<double>(law.k_p_per_s), share = static_cast<double>(law.road_torque_share);
    std::string t = fmt::format(
        "Where the shipped law cannot have {:.0f} dB upwards with its k_p and road_torque_share\n\n"
        "| surface | maneuver | at and below (m/s) | at drop-out: stable pole (rad/s) | upward margin (dB) | "
        "share that would have it |\n|---|---|---|---|---|---|\n",
        options.requirement.gain_dB);
    rows = ordered_json::array();
    for (const margins::Scenario& s : input.cases) {
        const auto pole = [&](double v) {
            const double slip = options.low_speed_fall
                                    ? margins::scheduled_slip(law, options.slip_reference, v)
                                    : options.slip_reference;
            return margins::operating_point(s.rig, v, slip).wheel_pole_radps(margins::Linearisation::full);
        };
        const auto speeds = margins::speed_grid(s.rig.brake_on_mps, s.drop_out_mps, kSpeeds);
        const auto at = std::find_if(speeds.begin(), speeds.end(), [&](double v) {
            return margins::creep_margin_dB(pole(v), share, k_p) < options.requirement.gain_dB;
        });
        if (at == speeds.end()) continue;
        const double last = pole(speeds.back());
        const double margin_dB = margins::creep_margin_dB(last, share, k_p);
        const double enough = std::pow(10.0, -options.requirement.gain_dB / 20.0) + k_p / last;
        fmt::format_to(std::back_inserter(t), "| {} | {} | {:.1f} | {:.0f} | {:.1f} | {:.2f} |\n", s.surface,
                       s.maneuver, *at, last, margin_dB, enough);
        rows.push_back({{"surface", s.surface},
                        {"maneuver", s.maneuver},
                        {"below_mps", *at},
                        {"pole_at_drop_out_radps", last},
                        {"upward_margin_dB", margin_dB},
                        {"share_that_would_have_it", enough}});
    }
    if (rows.empty()) t += "| none | | | | | |\n";
    return t;
}

struct TuneCommand {
    ScenarioOptions scenario;
    margins::StudyOptions options;
    int speeds = 4;
    margins::SearchOptions search;
    std::string loop = "pid";
    double floor = 0.9644;
    bool constant_slip = false;
    std::filesystem::path out = "out/tune";

    int run() {
        // CLI::Range lets a value pass that is no number.
        if (!std::isfinite(floor)) throw std::invalid_argument("--floor must be a number from 0 to 1");
        const MarginsInput input = load_margins_input(scenario);
        std::filesystem::create_directories(out);  // refused now, not when the search is over
        const antiskid::control::Config& controller = input.scenarios.front().controller;
        options.slip_reference = scenario.slip;
        options.speeds = speeds;
        options.low_speed_fall = !constant_slip;
        options.requirement = input.settings.requirement;
        search.seed = scenario.seed;
        const auto cells = margins::tuning_cells(input.cases, controller, options);
        const bool law = loop == "law";
        const auto judged = [&](const std::vector<double>& x) {
            return law ? margins::law_score(margins::with(controller, x), input.cases, cells,
                                            options.requirement)
                       : margins::pid_score(margins::with(input.settings.pid, x), input.cases, cells,
                                            options.requirement);
        };
        const auto score = [&](const std::vector<double>& x) {
            const double s = judged(x).value;
            // Margins that cost the stops their friction, their tracking or a lock are worth nothing.
            if (!law || s < 0.0) return s;
            const Acceptance a = accept(input, margins::with(controller, x));
            if (a.holds(floor)) return s;
            return -1.0 - std::max(0.0, floor - a.j_mu);
        };
        const auto knobs = law ? margins::law_knobs(controller) : margins::pid_knobs(input.settings.pid);
        const bool terminal = ::isatty(STDERR_FILENO) == 1;
        const auto found = margins::search(knobs, score, search, [terminal](int done, int all) {
            if (terminal) fmt::print(stderr, "\r{} of {} evaluations{}", done, all, done == all ? "\n" : "");
        });
        std::vector<double> start;
        std::transform(knobs.begin(), knobs.end(), std::back_inserter(start),
                       [](const margins::Knob& k) { return k.start; });
        ordered_json infeasible;
        const std::string table = infeasible_table(input, options, infeasible);

        ordered_json json{{"study", "tune"},
                          {"loop", loop},
                          {"config_hash", input.config_hash},
                          {"version", ANTISKID_VERSION},
                          {"seed", search.seed},
                          {"slip_reference", options.slip_reference},
                          {"evaluations", found.evaluations}};
        fmt::print(
            "{}: least of margins over required, worst of {} cells that are feasible at all\n\n"
            "| | shipped | tuned |\n|---|---|---|\n",
            law ? "slip law" : "PID on measured slip", cells.size());
        for (std::size_t i = 0; i < knobs.size(); ++i) {
            fmt::print("| {} | {:.4g} | {:.4g} |\n", knobs[i].name, start[i], found.values[i]);
            json["shipped"][knobs[i].name] = start[i];
            json["tuned"][knobs[i].name] = found.values[i];
        }
        const auto before = judged(start), after = judged(found.values);
        fmt::print(
            "| score | {:.3f} | {:.3f} |\n| cells that meet {:.0f} deg and {:.0f} dB | {} | {} |\n| unstable "
            "cells | {} | {} |\n",
            before.value, after.value, options.requirement.phase_deg, options.requirement.gain_dB, before.met,
            after.met, before.unstable, after.unstable);
        json["shipped"]["margins"] = to_json(before);
        json["tuned"]["margins"] = to_json(after);
        if (law) {
            const Acceptance a = accept(input, controller),
                             b = accept(input, margins::with(controller, found.values));
            fmt::print(
                "| mean J_mu | {:.4f} | {:.4f} |\n| longest lock (ms) | {:.0f} | {:.0f} |\n| least tracked "
                "share | {:.4f} | {:.4f} |\n",
                a.j_mu, b.j_mu, a.longest_lock_s * 1e3, b.longest_lock_s * 1e3, a.least_tracked,
                b.least_tracked);
            json["shipped"]["closed_loop"] = to_json(a);
            json["tuned"]["closed_loop"] = to_json(b);
        }
        ordered_json creeping;
        fmt::print("\n{}\n{}", table, creep_table(input, options, creeping));
        json["infeasible_at_constant_slip"] = infeasible;
        json["creeping"] = creeping;
        deliver((out / "results.json").string(), json.dump(2) + "\n");
        return 0;
    }
};

}  // namespace

LabVerb tune_verb(CLI::App& lab) {
    const auto command = std::make_shared<TuneCommand>();
    CLI::App* verb = lab.add_subcommand("tune",
                                        "Gains with the largest worst margin over all surfaces, maneuvers "
                                        "and speeds; what no controller can have.");
    verb->add_option("--loop", command->loop,
                     "pid: the paper's, by its margins; law: the shipped one, its stops kept as good")
        ->check(CLI::IsMember({"pid", "law"}))
        ->capture_default_str();
    verb->add_option("--slip", command->scenario.slip, "slip reference")
        ->check(CLI::Range(0.01, 0.5))
        ->capture_default_str();
    verb->add_option("--speeds", command->speeds, "speeds from brake-on to drop-out")
        ->check(CLI::Range(2, 50))
        ->capture_default_str();
    verb->add_flag("--constant-slip", command->constant_slip, "the reference does not fall at low speed");
    verb->add_option("--floor", command->floor, "law: least mean J_mu over all stops")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    verb->add_option("--population", command->search.population, "of the search")
        ->check(CLI::Range(4, 1000))
        ->capture_default_str();
    verb->add_option("--generations", command->search.generations, "of the search")
        ->check(CLI::Range(0, 10000))
        ->capture_default_str();
    verb->add_option("--seed", command->scenario.seed, "of the search, and of every sensor")
        ->capture_default_str();
    verb->add_option("--config", command->scenario.config, "directory of the configuration files")
        ->capture_default_str();
    verb->add_option("--out", command->out, "directory of results.json")->capture_default_str();
    verb->footer("Examples:\n  rig-lab tune\n  rig-lab tune --loop law --generations 15");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim
