#include "plant_sim/lab/tune_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/host/controller_config.hpp"
#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/settings/settings.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/margins/law_judge.hpp"
#include "plant_sim/study/robust/robust_campaign.hpp"

namespace plant_sim::lab {

namespace {

namespace margins = study::margins;
using antiskid::control::Config;
using settings::Json;

struct Gain {
    std::string key;  ///< of [slip]
    double value = 0.0;
};

/// The shortest text that is this number, with a point: TOML takes "6" for an integer.
std::string number(double value) {
    std::string text = fmt::format("{}", value);
    return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

/// [slip] with one line a gain, in their order; `head` stands above as a comment.
std::string gains_as_toml(const std::vector<Gain>& gains, const std::string& head) {
    std::string text = fmt::format("# {}\n[slip]\n", head);
    for (const Gain& g : gains) text += fmt::format("{} = {}\n", g.key, number(g.value));
    return text;
}

/// `toml` with these values in the place of those that it has; comments and everything else stay. Throws std::invalid_argument naming a key
/// that is not there, on a line of its own below [slip].
std::string with_gains_written(const std::string& toml, const std::vector<Gain>& gains) {
    std::string written = toml;
    const std::size_t table = toml.find("\n[slip]\n");
    for (const Gain& g : gains) {
        const std::size_t end = std::min(written.find("\n[", table + 1), written.size());
        const std::size_t line = written.find("\n" + g.key + " = ", table);
        if (table == std::string::npos || line >= end) throw std::invalid_argument("no line '" + g.key + " = ...' below [slip]");
        const std::size_t value = line + g.key.size() + 4;
        written.replace(value, written.find_first_of(" #\r\n", value) - value, number(g.value));
    }
    return written;
}

/// Plants and runways that differ from what the controller believes.
void add_drawn(margins::TrialStops& trial, const StopOptions& options, const margins::LawSearch& law) {
    robust::RobustPlanOptions drawn;
    drawn.config = options.config;
    drawn.controller = options.controller;
    drawn.seed = law.drawn_seed;
    drawn.laws = {"slip"};
    const robust::RobustPlan plan = robust::load_plan(drawn);
    for (const auto& [family, min_j_mu] : law.min_drawn_j_mu) {
        for (std::size_t n = 0; n < law.draws; ++n)
            trial.stops.push_back(
                {trial.groups.size(), robust::draw(plan.basis, family, plan.seed, n).rig, robust::session(plan, plan.laws.front(), n)});
        trial.groups.emplace_back(robust::name(family));
        trial.min_j_mu.push_back(min_j_mu);
    }
}

/// The stops of all scenarios, short ones first, and the friction that the threshold law has in them.
margins::TrialStops trial_stops(const StopOptions& options, const margins::MarginsInput& input) {
    StopOptions other = options;
    other.law = "threshold";
    const margins::MarginsInput threshold = margins::load_margins_input(other);
    margins::TrialStops trial;
    trial.layout = &input.scenarios.front().layout;
    margins::TrialStops baseline;
    baseline.layout = trial.layout;
    for (std::size_t i = 0; i < input.cases.size(); ++i) {
        const std::string& surface = input.cases[i].surface;
        if (trial.groups.empty() || trial.groups.back() != surface) trial.groups.push_back(surface);
        const std::size_t s = trial.groups.size() - 1;
        trial.stops.push_back({s, input.scenarios[i].plant.rig, input.scenarios[i].session});
        baseline.stops.push_back({s, threshold.scenarios[i].plant.rig, threshold.scenarios[i].session});
    }
    trial.surfaces = baseline.surfaces = trial.groups.size();
    baseline.groups = trial.groups;
    baseline.min_j_mu.assign(trial.surfaces, 0.0);
    trial.min_j_mu = margins::make_stops(baseline, input.scenarios.front().controller, std::numeric_limits<double>::infinity()).group_j_mu;
    for (double& min : trial.min_j_mu) min -= input.settings.law.surface_loss;
    trial.requirement = input.settings.law.stops;
    // A law may hold the slip with the brake that it knows and lose it with a worn one.
    for (const double reference : input.settings.law.worn_references) {
        StopOptions worn = options;
        worn.slip = reference;
        worn.choice.friction = input.settings.law.worn_friction;
        const margins::MarginsInput stops = margins::load_margins_input(worn);
        for (std::size_t i = 0; i < stops.cases.size(); ++i) {
            const margins::StopConditions& c = stops.cases[i];
            if (c.maneuver != stops.cases.front().maneuver) continue;
            const auto at = margins::operating_point(c.rig, c.rig.brake_on_mps, reference);
            if (at.pressure_Pa > c.full_pressure_Pa) continue;  // nobody can hold that
            const auto s = std::find(trial.groups.begin(), trial.groups.end(), c.surface);
            trial.stops.push_back({static_cast<std::size_t>(s - trial.groups.begin()), c.rig, stops.scenarios[i].session, false});
        }
    }
    add_drawn(trial, options, input.settings.law);
    // The slipperiest surface's stops take more time than all the others.
    const auto grip = [](const margins::TrialStop& t) { return rig::peak(t.rig.surface).mu; };
    std::stable_sort(trial.stops.begin(), trial.stops.end(),
                     [&](const margins::TrialStop& a, const margins::TrialStop& b) { return grip(a) > grip(b); });
    trial.first = static_cast<std::size_t>(
        std::find_if(trial.stops.begin(), trial.stops.end(), [&](const margins::TrialStop& t) { return t.group == trial.stops.back().group; }) -
        trial.stops.begin());
    return trial;
}

struct JudgedGains {
    std::vector<double> gains;
    margins::WorstScore margins;
    margins::StopsShown stops;
};

Json to_json(const JudgedGains& j, const margins::TrialStops& trial) {
    Json json;
    for (std::size_t i = 0; i < j.gains.size(); ++i) json[margins::gain_names()[i]] = j.gains[i];
    json["margins"] = {{"score", j.margins.value}, {"cells", j.margins.counted}, {"unstable", j.margins.unstable}, {"met", j.margins.met}};
    json["closed_loop"] = {
        {"mean_j_mu", j.stops.mean_j_mu}, {"longest_lock_s", j.stops.longest_lock_s}, {"min_tracked_share", nullptr}, {"faults", j.stops.faults}};
    if (j.stops.min_tracked) json["closed_loop"]["min_tracked_share"] = *j.stops.min_tracked;
    for (std::size_t g = 0; g < trial.groups.size(); ++g)
        json["closed_loop"][g < trial.surfaces ? "j_mu" : "drawn_j_mu"][trial.groups[g]] = j.stops.group_j_mu[g];
    return json;
}

/// A column for each of `judged`: the shipped gains, and those that were found.
void print(const std::vector<JudgedGains>& judged, const margins::TrialStops& trial, const margins::Requirement& asked,
           const std::string& json_file) {
    auto table = settings::TextTable::markdown(judged.size() > 1 ? "|shipped|tuned" : "|shipped");
    const auto row = [&](const std::string& label, const auto& value) {
        table.add(label);
        for (const JudgedGains& j : judged) table.add(value(j));
    };
    for (std::size_t i = 0; i < margins::gain_names().size(); ++i)
        row(margins::gain_names()[i], [&](const JudgedGains& j) { return fmt::format("{:.4g}", j.gains[i]); });
    row("score", [](const JudgedGains& j) { return fmt::format("{:.3f}", j.margins.value); });
    row(fmt::format("cells that meet {:.0f} deg and {:.0f} dB", asked.phase_deg, asked.gain_dB), [](const JudgedGains& j) { return j.margins.met; });
    row("unstable cells", [](const JudgedGains& j) { return j.margins.unstable; });
    row(fmt::format("mean J_mu (at least {:.4f})", trial.requirement.mean_j_mu),
        [](const JudgedGains& j) { return fmt::format("{:.4f}", j.stops.mean_j_mu); });
    for (std::size_t g = 0; g < trial.groups.size(); ++g)
        row(fmt::format("J_mu, {} (at least {:.4f})", trial.groups[g], trial.min_j_mu[g]),
            [&](const JudgedGains& j) { return fmt::format("{:.4f}", j.stops.group_j_mu[g]); });
    row("longest lock (ms)", [](const JudgedGains& j) { return fmt::format("{:.0f}", j.stops.longest_lock_s * 1e3); });
    row("least tracked share",
        [](const JudgedGains& j) { return j.stops.min_tracked ? fmt::format("{:.4f}", *j.stops.min_tracked) : "not measured"; });
    print_table(json_file, "Slip law: least of margins over required, worst of {} cells\n\n{}", judged.front().margins.counted, table.text());
}

}  // namespace

int tune_law(const LawTuning& tuning, const margins::MarginsInput& input, Json& json) {
    const Config& controller = input.scenarios.front().controller;
    const margins::LawSearch& law = input.settings.law;
    const margins::TrialStops trial = trial_stops(tuning.scenario, input);
    const margins::LawJudge judge(input.cases, trial, tuning.options);
    const auto score = [&](const std::vector<double>& x, double to_beat) { return judge.score(margins::with_gains(controller, x), to_beat); };
    const auto progress = settings::step_progress("gains judged");
    const auto judged = [&](const std::vector<double>& gains) {
        const Config c = margins::with_gains(controller, gains);
        return JudgedGains{gains, judge.margins_of(c), margins::make_stops(trial, c, std::numeric_limits<double>::infinity())};
    };

    std::vector<double> shipped = margins::gains_of(controller);
    for (double& g : shipped) g = margins::rounded(g, tuning.search.digits);
    const JudgedGains before = judged(shipped);
    json["shipped"] = to_json(before, trial);
    if (tuning.check) {
        print({before}, trial, tuning.options.requirement, tuning.json_file);
        const bool shows = before.stops.violation <= 0.0;
        print_table(tuning.json_file, "\nThe shipped gains {} what stops must show.\n", shows ? "show" : "do not show");
        return shows ? 0 : 1;
    }
    const margins::Found found = margins::search(law.parameters, score, tuning.search, progress);
    const margins::Found top = margins::climb(law.parameters, found.values, score, law.min_gain, tuning.search, progress);

    const JudgedGains after = judged(top.values);
    print({before, after}, trial, tuning.options.requirement, tuning.json_file);
    json["evaluations"] = found.evaluations + top.evaluations;
    json["tuned"] = to_json(after, trial);

    std::vector<Gain> gains;
    for (std::size_t i = 0; i < top.values.size(); ++i) gains.push_back({margins::gain_names()[i], top.values[i]});
    settings::write_file(tuning.out / "slip.toml", gains_as_toml(gains, fmt::format("rig-lab tune --loop law, seed {}, version {}, configuration {}",
                                                                                    tuning.search.seed, ANTISKID_VERSION, input.config_hash)));
    for (const auto& file : tuning.write) settings::write_file(file, with_gains_written(settings::Document::load(file).bytes(), gains));
    return 0;
}

}  // namespace plant_sim::lab
