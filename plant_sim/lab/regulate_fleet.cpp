#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "firmware/host/stop_signals.hpp"
#include "plant_sim/lab/regulate_stops.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/regulation/fleet_study.hpp"
#include "rig_bridge/pictures/figure.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"
#include "rig_bridge/wear/on_threads.hpp"

namespace plant_sim::lab {

namespace {

using regulation::Choice;
using regulation::FleetResult;
using regulation::Judged;
using regulation::Saving;
using regulation::Visit;

bool certain(const Saving& s) {
    return std::abs(s.per_landing) > 2.0 * s.standard_error;
}

struct FleetReport {
    regulation::FleetConfig config;
    std::vector<Judged> policies;  ///< the plainest first
    std::string config_hash;

    /// The cheapest of those that an owner can choose, that is without the one that has a bay for each aircraft.
    [[nodiscard]] const Judged& cheapest() const {
        return *std::min_element(policies.begin(), policies.end(), [](const Judged& a, const Judged& b) {
            return std::pair(a.policy.own_bay, regulation::per_landing(a)) < std::pair(b.policy.own_bay, regulation::per_landing(b));
        });
    }
    /// The plainest that costs no more than the cheapest one, or by no more than two standard errors.
    [[nodiscard]] const Judged& recommended() const {
        return *std::find_if(policies.begin(), policies.end(), [&](const Judged& p) { return !certain(regulation::saving(cheapest(), p)); });
    }
};

/// Of all fleets of one policy, per landing.
struct Means {
    double landings = 0.0;
    double brake = 0.0, tyre = 0.0, visit = 0.0, ground = 0.0, distance = 0.0;
    double visits = 0.0, both = 0.0, waiting_days = 0.0;
};

Means means_of(const Judged& policy) {
    Means m;
    for (const FleetResult& f : policy.fleets) m.landings += static_cast<double>(f.landings);
    for (const FleetResult& f : policy.fleets) {
        m.brake += f.money.brake / m.landings;
        m.tyre += f.money.tyre / m.landings;
        m.visit += f.money.visit / m.landings;
        m.ground += f.money.ground / m.landings;
        m.distance += f.money.distance / m.landings;
        m.waiting_days += f.waiting_days / m.landings;
        m.visits += static_cast<double>(f.visits.size()) / m.landings;
        m.both += static_cast<double>(std::count_if(f.visits.begin(), f.visits.end(), [](const Visit& v) { return v.brake && v.tyre; })) / m.landings;
    }
    return m;
}

std::string numbers_of(const Judged& judged) {
    const regulation::FleetPolicy& p = judged.policy;
    const std::string wear = p.share->reference ? fmt::format("slip {:.2f}", *p.share->reference)
                                                : fmt::format("share {}{:.2f}", p.together ? "about " : "", p.share->mean_share);
    return p.visits == regulation::Visits::at_limit ? wear : fmt::format("{}, {:.0f} d", wear, p.margin_days);
}

const Judged& named(const FleetReport& r, std::string_view name) {
    return *std::find_if(r.policies.begin(), r.policies.end(), [&](const Judged& p) { return p.name == name; });
}

/// An idea, the policy that has it, and the one that lacks nothing else.
struct Question {
    const char* idea;
    const char* with;
    const char* without;
};
constexpr std::array kQuestions{
    Question{"Booking visits before the limit", "each by itself, booked", "each by itself, at the limit"},
    Question{"A reference for each surface instead of one", "best fixed share, booked", "best fixed reference, booked"},
    Question{"Wearing out brake and tyre of each aircraft together", "each by itself, booked", "best fixed share, booked"},
    Question{"Moving wear so that visits do not collide", "each by itself, spread", "each by itself, booked"},
    Question{"A bay for each aircraft, as if bays cost nothing", "each by itself, booked, a bay for each", "each by itself, booked"},
};

const char* verdict(const Saving& s) {
    if (!certain(s)) return "NOTHING THAT THESE FLEETS SHOW";
    return s.per_landing > 0.0 ? "PAYS" : "DOES NOT PAY";
}

std::string to_text(const FleetReport& r) {
    const regulation::FleetConfig& c = r.config;
    std::string text =
        fmt::format("{} aircraft with {} landings a day, {} {}, {} days a visit, {:.0f} a day on the ground; {} fleets over {} days\n\n", c.aircraft,
                    c.rules.landings_a_day, c.rules.shop.bays, c.rules.shop.bays == 1 ? "bay" : "bays", c.rules.shop.visit_days, c.rules.ground_day,
                    r.policies.front().fleets.size(), c.rules.days);
    auto table = settings::TextTable::markdown(
        "policy|chosen on other fleets|cost a landing:.2f|saved|brake:.2f|tyre:.2f|visits:.2f|ground:.2f|distance:.2f|visits in 1,000 landings:.2f|"
        "of both parts:.2f|days of waiting for a bay:.2f");
    for (const Judged& p : r.policies) {
        const Means m = means_of(p);
        const Saving s = regulation::saving(p, r.policies.front());
        table.add(p.name, numbers_of(p), regulation::per_landing(p), fmt::format("{:.2f} +- {:.2f}", s.per_landing, s.standard_error), m.brake,
                  m.tyre, m.visit, m.ground, m.distance, 1e3 * m.visits, 1e3 * m.both, 1e3 * m.waiting_days);
    }
    text += table.text() + "\nsaved a landing, against the same policy without it, each with its own numbers:\n";
    for (const Question& q : kQuestions) {
        const Saving s = regulation::saving(named(r, q.with), named(r, q.without));
        text += fmt::format("  {}: {:.2f} +- {:.2f}, {}\n", q.idea, s.per_landing, s.standard_error, verdict(s));
    }
    return text +
           fmt::format("cheapest: {}; the plainest that costs no more, as far as these fleets show: {}\n", r.cheapest().name, r.recommended().name);
}

std::string to_json(const FleetReport& r) {
    const auto set = [](const regulation::FleetSet& s) {
        settings::Json laws = settings::Json::array();
        for (const auto law : s.laws) laws.push_back(wear::arena::kLawNames.at(static_cast<std::size_t>(law)));
        return settings::Json{{"laws", laws}, {"first_seed", s.first_seed}, {"fleets_of_each", s.fleets}};
    };
    settings::Json json{{"study", "regulate fleet"},
                        {"version", ANTISKID_VERSION},
                        {"config_hash", r.config_hash},
                        {"source", "brakes made up by the laws of plant_sim/wear/rival_laws.hpp"},
                        {"aircraft", r.config.aircraft},
                        {"landings_a_day", r.config.rules.landings_a_day},
                        {"days", r.config.rules.days},
                        {"bays", r.config.rules.shop.bays},
                        {"visit_days", r.config.rules.shop.visit_days},
                        {"ground_day", r.config.rules.ground_day},
                        {"tuning", set(r.config.tuning)},
                        {"held_out", set(r.config.held_out)},
                        {"cheapest", r.cheapest().name},
                        {"recommended", r.recommended().name}};
    for (const Judged& p : r.policies) {
        const Means m = means_of(p);
        const Saving s = regulation::saving(p, r.policies.front());
        settings::Json one{{"name", p.name},
                           {"tyre_share", p.policy.share->mean_share},
                           {"together", p.policy.together},
                           {"margin_days", p.policy.margin_days},
                           {"cost_per_landing", regulation::per_landing(p)},
                           {"saved", s.per_landing},
                           {"saved_standard_error", s.standard_error},
                           {"brake", m.brake},
                           {"tyre", m.tyre},
                           {"visit", m.visit},
                           {"ground", m.ground},
                           {"distance", m.distance},
                           {"visits_per_landing", m.visits},
                           {"visits_of_both_per_landing", m.both},
                           {"waiting_days_per_landing", m.waiting_days}};
        if (p.policy.share->reference) one["slip_reference"] = *p.policy.share->reference;
        for (const FleetResult& f : p.fleets) one["cost_per_landing_by_fleet"].push_back(f.per_landing());
        json["policies"].push_back(std::move(one));
    }
    for (const Question& q : kQuestions) {
        const Saving s = regulation::saving(named(r, q.with), named(r, q.without));
        json["questions"].push_back(
            {{"idea", q.idea}, {"with", q.with}, {"without", q.without}, {"saved", s.per_landing}, {"saved_standard_error", s.standard_error}});
    }
    return settings::json_page(json);
}

/// All visits of all fleets under all policies.
std::string to_csv(const FleetReport& r) {
    auto csv = settings::TextTable::csv("policy|fleet|aircraft|grounded_day|begin_day|end_day|brake_changed|tyre_changed");
    for (const Judged& p : r.policies) {
        const std::string policy = '"' + p.name + '"';
        for (std::size_t f = 0; f < p.fleets.size(); ++f)
            for (const Visit& v : p.fleets[f].visits)
                csv.add(policy, f + 1, v.aircraft + 1, v.grounded, v.begin, v.begin + r.config.rules.shop.visit_days, v.brake ? 1 : 0,
                        v.tyre ? 1 : 0);
    }
    return csv.text();
}

/// Cost by policy, and the visits of one fleet's first year under the plainest policy and the recommended one. Throws std::runtime_error if gnuplot
/// fails.
void draw(const FleetReport& r, const std::filesystem::path& png) {
    using pictures::Series;
    using pictures::Style;
    Series each{.name = "each fleet", .style = Style::points, .colour = pictures::grey};
    Series mean{.name = "all fleets", .style = Style::points, .colour = pictures::vermillion};
    const auto count = static_cast<double>(r.policies.size());
    double least = std::numeric_limits<double>::infinity(), greatest = 0.0;
    for (std::size_t p = 0; p < r.policies.size(); ++p) {
        const double line = count - static_cast<double>(p);
        for (const FleetResult& f : r.policies[p].fleets) {
            each.add(f.per_landing(), line);
            least = std::min(least, f.per_landing());
            greatest = std::max(greatest, f.per_landing());
        }
        mean.add(regulation::per_landing(r.policies[p]), line + 0.35);
        mean.notes.push_back(r.policies[p].name);
    }
    const pictures::Chart costs{.title = "cost by policy",
                                .y_label = "policy",
                                .x_label = "money a landing",
                                .series = {std::move(each), std::move(mean)},
                                .x_range = pictures::Range{least - 0.5, greatest + 0.4 * (greatest - least)},
                                .y_range = pictures::Range{0.5, count + 1.0}};
    const int year = std::min(365, r.config.rules.days);
    const auto visits = [&](const Judged& p) {
        std::vector<Series> bars;  // one for each, since draw() joins what is near in a long series
        const auto bar = [&](const char* name, std::size_t colour, int from, int to, std::size_t aircraft) {
            const bool first = std::none_of(bars.begin(), bars.end(), [&](const Series& s) { return s.name == name; });
            Series& s = bars.emplace_back(Series{.name = name, .colour = colour, .width = 5.0, .in_legend = first});
            for (const int day : {from, to}) s.add(day, static_cast<double>(aircraft + 1));
        };
        for (const Visit& v : p.fleets.front().visits) {
            const int end = v.begin + r.config.rules.shop.visit_days;
            if (end > year) break;
            bar("in the shop", pictures::blue, v.begin, end, v.aircraft);
            if (v.grounded < v.begin) bar("waits for a bay", pictures::vermillion, v.grounded, v.begin, v.aircraft);
        }
        return pictures::Chart{.title = p.name,
                               .y_label = "aircraft",
                               .x_label = "day",
                               .series = std::move(bars),
                               .x_range = pictures::Range{0.0, static_cast<double>(year)},
                               .y_range = pictures::Range{0.0, r.config.aircraft + 1.0}};
    };
    pictures::draw({.title = fmt::format("{} aircraft, {} {}: visits and what they cost", r.config.aircraft, r.config.rules.shop.bays,
                                         r.config.rules.shop.bays == 1 ? "bay" : "bays"),
                    .charts = {costs, visits(r.policies.front()), visits(r.recommended())}},
                   png);
}

struct RegulateFleetCommand {
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path out = "out/fleet";
    std::string json_file;  ///< "-": standard output
    std::optional<int> aircraft, bays, visit_days, fleets;
    std::optional<double> ground_day;
    std::optional<std::uint64_t> seed;
    unsigned threads = wear::all_cores();

    [[nodiscard]] int run() const {
        const wear::RegulationConfig owner = wear::load_regulation_config(config / "regulation.toml");
        const std::filesystem::path arena_file = config / "wear_arena.toml", fleet_file = config / "fleet.toml";
        regulation::FleetConfig asked = regulation::load_fleet_config(fleet_file);
        asked.aircraft = aircraft.value_or(asked.aircraft);
        asked.rules.shop.bays = bays.value_or(asked.rules.shop.bays);
        asked.rules.shop.visit_days = visit_days.value_or(asked.rules.shop.visit_days);
        asked.rules.ground_day = ground_day.value_or(asked.rules.ground_day);
        asked.rules.prices = owner.prices;
        asked.held_out.first_seed = seed.value_or(asked.held_out.first_seed);
        asked.held_out.fleets = fleets.value_or(asked.held_out.fleets);
        const LandingSites sites = load_sites(config);
        antiskid::host::StopSignals signals;
        regulation::FleetStudy study = study_of(owner, asked, sites, wear::arena::load_settings(arena_file));
        study.threads = threads;
        study.stop = &signals.stop();
        const auto count = [](const regulation::FleetSet& set) { return static_cast<std::int64_t>(set.laws.size()) * set.fleets; };
        settings::Progress progress(count(asked.tuning) + count(asked.held_out), 0, "fleets");
        study.on_fleets = [&](std::size_t done) { progress.show(static_cast<std::int64_t>(done)); };
        const std::vector<Choice> references = references_of(owner);
        FleetReport report{.config = asked, .policies = regulation::judge(study, regulation::entrants(study, references)), .config_hash = {}};
        progress.finish();
        if (report.policies.empty()) return signals.exit_status();
        std::vector<std::filesystem::path> files = sites.files;
        files.insert(files.end(), owner.files.begin(), owner.files.end());
        files.insert(files.end(), {arena_file, fleet_file});
        report.config_hash = settings::hash(files);
        print_table(json_file, "{}", to_text(report));
        write_json(out / "fleet.json", json_file, to_json(report));
        settings::write_file(out / "visits.csv", to_csv(report));
        draw(report, out / "fleet.png");
        print_table(json_file, "  {}, {}, {}\n", (out / "fleet.json").string(), (out / "visits.csv").string(), (out / "fleet.png").string());
        return 0;
    }

  private:
    [[nodiscard]] static regulation::FleetStudy study_of(const wear::RegulationConfig& owner, const regulation::FleetConfig& asked,
                                                         const LandingSites& sites, const wear::arena::Settings& arena) {
        const double brake_life_J = sites.sites.front().rig.wear.life_J;
        regulation::AircraftKind kind{.landing_J = {},
                                      .law = {},
                                      .brakes = arena,
                                      .past = {},
                                      .tyre_life_J = owner.plan.tyre_life_J,
                                      .deviations = owner.deviations,
                                      .inspection_landings = asked.inspection_landings};
        for (const LandingSite& site : sites.sites)  // a maneuver brings the same energy on every surface
            if (site.surface == sites.sites.front().surface) kind.landing_J.push_back(site.kinetic_J());
        const Choice usual = regulation::choice_of(owner.floor, owner.rules.default_reference);
        const double brake_J = (1.0 - usual.mean_share) * kind.mean_landing_J();
        kind.brakes.mix = {{.name = "landing", .share = 1.0, .energy_J = brake_J, .deviation_J = 0.0}};
        kind.brakes.life_landings = brake_life_J / brake_J;
        kind.brakes.life_scatter = owner.deviations.brake;
        const regulation::Costs costs{.brake_per_J = owner.prices.brake / brake_life_J,
                                      .tyre_per_J = owner.prices.tyre / kind.tyre_life_J,
                                      .visit = owner.prices.visit + asked.rules.shop.visit_days * asked.rules.ground_day,
                                      .metre = owner.prices.metre,
                                      .planned = {.brake_J = brake_life_J, .tyre_J = kind.tyre_life_J}};
        return {.kind = std::move(kind),
                .choices = regulation::Choices(owner.floor, owner.rules.j_mu_floor, owner.rules.default_reference),
                .costs = costs,
                .config = asked,
                .training_seed = arena.training};
    }
    /// The default one, then all that are allowed on every surface.
    [[nodiscard]] static std::vector<Choice> references_of(const wear::RegulationConfig& owner) {
        std::vector<Choice> all{regulation::choice_of(owner.floor, owner.rules.default_reference)};
        constexpr std::size_t kEvery = 2;  // of the table's references
        const std::vector<double> allowed = wear::references_in(owner.floor, owner.range());
        all.reserve(1 + allowed.size());
        for (std::size_t i = 0; i < allowed.size(); i += kEvery) all.push_back(regulation::choice_of(owner.floor, allowed[i]));
        return all;
    }
};

}  // namespace

LabVerb regulate_fleet_verb(CLI::App& regulate) {
    const auto command = std::make_shared<RegulateFleetCommand>();
    CLI::App* verb =
        regulate.add_subcommand("fleet",
                                "Several aircraft and one shop: whether it saves money to move wear between brake and tyre so that visits "
                                "are shared and do not collide. By the table of surfaces.");
    const auto number = [&](const char* option, std::optional<int>& value, int max, const char* text) {
        verb->add_option(option, value, text)->check(CLI::Range(1, max));
    };
    number("--aircraft", command->aircraft, regulation::kMaxAircraft, "of each fleet (default: the one of fleet.toml)");
    number("--bays", command->bays, regulation::kMaxAircraft, "of the shop (default: likewise)");
    number("--visit-days", command->visit_days, 1000, "that a visit takes (default: likewise)");
    verb->add_option("--ground-day", command->ground_day, "money that an aircraft on the ground costs a day (default: likewise)")
        ->check(CLI::Range(0.0, 1e9));
    verb->add_option("--fleets", command->fleets, "judged, of each law of wear (default: likewise)")->check(CLI::Range(2, 1000));
    verb->add_option("--seed", command->seed, "of the first aircraft that is judged (default: likewise)")->check(CLI::NonNegativeNumber);
    settings::add_json(*verb, command->json_file, "results");
    settings::add_out(*verb, command->out, "directory for fleet.json, visits.csv, fleet.png");
    settings::add_config_directory(*verb, command->config);
    settings::add_threads(*verb, command->threads);
    verb->footer(
        "Examples:\n"
        "  rig-lab regulate fleet\n"
        "  rig-lab regulate fleet --aircraft 24 --ground-day 500\n"
        "  rig-lab regulate fleet --bays 2 --visit-days 5 --out out/two_bays");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim::lab
