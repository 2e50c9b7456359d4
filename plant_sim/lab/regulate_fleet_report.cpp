#include "plant_sim/lab/regulate_fleet_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "rig_bridge/pictures/figure.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

namespace plant_sim::lab {

namespace {

using regulation::FleetResult;
using regulation::Judged;
using regulation::Saving;
using regulation::Visit;

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

bool certain(const Saving& s) {
    return std::abs(s.per_landing) > 2.0 * s.standard_error;
}

const char* verdict(const Saving& s) {
    if (!certain(s)) return "NOTHING THAT THESE FLEETS SHOW";
    return s.per_landing > 0.0 ? "PAYS" : "DOES NOT PAY";
}

}  // namespace

const Judged& FleetReport::cheapest() const {
    return *std::min_element(policies.begin(), policies.end(), [](const Judged& a, const Judged& b) {
        return std::pair(a.policy.own_bay, regulation::per_landing(a)) < std::pair(b.policy.own_bay, regulation::per_landing(b));
    });
}

const Judged& FleetReport::recommended() const {
    return *std::find_if(policies.begin(), policies.end(), [&](const Judged& p) { return !certain(regulation::saving(cheapest(), p)); });
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

}  // namespace plant_sim::lab
