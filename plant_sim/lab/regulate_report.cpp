#include "plant_sim/lab/regulate_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "rig_bridge/pictures/figure.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

namespace plant_sim::lab {

namespace {

using regulation::First;
using regulation::Life;
using regulation::LifeRow;
using regulation::PolicyLives;
using regulation::Summary;

/// A life may end with its landings before anything was used up: a plan that is far too long for them.
const char* first_limit(const Life& life) {
    const LifeRow& last = life.rows.back();
    if (last.brake_J < life.brake_budget_J && last.tyre_J < life.tyre_budget_J) return "none";
    return life.first == First::brake ? "brake" : "tyre";
}

std::string life_text(const Life& life, int number, const wear::WearPlan& plan) {
    const std::string what = life.feasible ? (life.met ? "feasible, met" : "feasible, MISSED")
                                           : fmt::format("not feasible at landing {}: the landings bring {:.1f} % of what is left{}", plan.landings,
                                                         life.brought * 100.0, life.other_left <= plan.tolerance ? "; both limits together" : "");
    return fmt::format(
        "  life {:>2}: brake {:6.2f} %, tyre {:6.2f} % used at landing {}; first limit: {}, at {:.1f}, then {:.2f} % of the other left; {}\n", number,
        life.brake_at_plan * 100.0, life.tyre_at_plan * 100.0, plan.landings, first_limit(life), life.first_landing, life.other_left * 100.0, what);
}

settings::Json life_json(const Life& life) {
    return {{"feasible", life.feasible},
            {"met", life.met},
            {"brought", life.brought},
            {"brake_budget_J", life.brake_budget_J},
            {"tyre_budget_J", life.tyre_budget_J},
            {"brake_used_at_plan", life.brake_at_plan},
            {"tyre_used_at_plan", life.tyre_at_plan},
            {"first_limit", first_limit(life)},
            {"first_limit_landing", life.first_landing},
            {"other_left_at_first_limit", life.other_left},
            {"floor_held", life.floor_held}};
}

/// The fixed reference that the energies are shown against: the paper's, or the first there is.
std::size_t shown_fixed(const RegulateReport& r) {
    for (std::size_t p = 1; p < r.policies.size(); ++p) {
        if (r.policies[p].policy.fixed == r.rules.default_reference) return p;
    }
    return 1;
}

std::string money_text(const RegulateReport& r) {
    std::string text = fmt::format(
        "\nin the owner's money, a landing: {:.2f} is the least that any choice of references can cost, {:.2f} where one must serve all surfaces; "
        "{:.2f} "
        "where nobody cares for common visits\n",
        r.cost_bound, r.cost_untold, r.cost_unshared);
    const std::vector<bool> possible = r.feasible();
    for (const PolicyLives& p : r.policies) {
        const double cost = r.cost_bound + regulation::summary(p, possible, r.plan.tolerance).loss;
        if (!p.policy.fixed && !p.policy.bound && cost > r.cost_unshared)
            text += fmt::format("SHARING A VISIT DOES NOT PAY at these prices for \"{}\": {:.2f}\n", p.policy.name, cost);
    }
    return text;
}

}  // namespace

std::vector<bool> RegulateReport::feasible() const {
    std::vector<bool> all;
    all.reserve(policies.front().lives.size());
    for (const Life& life : policies.front().lives) all.push_back(life.feasible);
    return all;
}

bool RegulateReport::all_met() const {
    const auto& lives = policies.front().lives;
    return std::all_of(lives.begin(), lives.end(), [](const Life& life) { return life.floor_held && (life.met || !life.feasible); });
}

std::string to_text(const RegulateReport& r) {
    std::string text = fmt::format(
        "plan: {:.1f} MJ of brake and {:.1f} MJ of tyre used up together at landing {}; a landing brings {:.3f} +- {:.3f} MJ\n"
        "references {:.3f} to {:.3f} keep J_mu at {:.2f} or above\n{}\n",
        r.plan.brake_budget_J() * 1e-6, r.plan.tyre_budget_J() * 1e-6, r.plan.landings, r.plan.landing_J * 1e-6, r.plan.landing_deviation_J * 1e-6,
        r.range.lowest, r.range.highest, r.rules.j_mu_floor, wear::sentence(r.limits, r.plan));
    const PolicyLives& regulated = r.policies.front();
    for (std::size_t i = 0; i < regulated.lives.size(); ++i) text += life_text(regulated.lives[i], static_cast<int>(i) + 1, r.plan);
    auto table = settings::TextTable::markdown(
        "policy|met, of feasible lives|together, of all lives|first limit at landing:.1f|left of the other: mean:|worst|mean J_mu:.4f|least "
        "J_mu:.3f|mean "
        "distance (m):.1f|cost a landing:.2f|above the bound:.2f");
    const auto percent = [](double share, int digits) { return fmt::format("{:.{}f} %", share * 100.0, digits); };
    const std::vector<bool> possible = r.feasible();
    for (const PolicyLives& p : r.policies) {
        const Summary s = regulation::summary(p, possible, r.plan.tolerance);
        table.add(p.policy.name, fmt::format("{} of {}", s.met, s.feasible), fmt::format("{} of {}", s.together, p.lives.size()), s.first_landing,
                  percent(s.other_left, 2), percent(s.worst_other_left, 2), s.j_mu, s.min_j_mu, s.distance_m, s.cost, s.loss);
    }
    text += "\n" + table.text() + money_text(r);
    const Summary s = regulation::summary(regulated, possible, r.plan.tolerance);
    text += fmt::format("\n{}\n", !r.options.worst_stops ? "stop distances were not checked against the floor"
                                  : s.floor_held         ? "no regulated stop was longer than at the worst reference that the floor allows"
                                                         : "A REGULATED STOP WAS LONGER than at the worst reference that the floor allows");
    return text;
}

std::string to_json(const RegulateReport& r) {
    settings::Json json{{"study", "regulate"},
                        {"version", ANTISKID_VERSION},
                        {"config_hash", r.config_hash},
                        {"seed", r.options.seed},
                        {"plan",
                         {{"landings", r.plan.landings},
                          {"brake_life_J", r.plan.brake_life_J},
                          {"brake_taken_J", r.plan.brake_taken_J},
                          {"tyre_life_J", r.plan.tyre_life_J},
                          {"tyre_taken_J", r.plan.tyre_taken_J},
                          {"landing_J", r.plan.landing_J},
                          {"landing_deviation_J", r.plan.landing_deviation_J},
                          {"tolerance", r.plan.tolerance}}},
                        {"range", {{"lowest", r.range.lowest}, {"highest", r.range.highest}, {"j_mu_floor", r.rules.j_mu_floor}}},
                        {"prediction",
                         {{"verdict", wear::name(r.limits.verdict)},
                          {"sentence", wear::sentence(r.limits, r.plan)},
                          {"required_share", r.limits.required_share},
                          {"min_share", r.limits.min_share},
                          {"max_share", r.limits.max_share},
                          {"brake_limit_landing", r.limits.brake.landing},
                          {"brake_limit_deviation", r.limits.brake.deviation},
                          {"tyre_limit_landing", r.limits.tyre.landing},
                          {"tyre_limit_deviation", r.limits.tyre.deviation},
                          {"probability", r.limits.probability}}},
                        {"mix", r.options.mix == regulation::Mix::random ? "random" : "balanced"},
                        {"missing", r.options.missing},
                        {"life_deviation", r.options.brake_deviation},
                        {"tyre_deviation", r.options.tyre_deviation},
                        {"inspection_landings", r.options.each.inspection.landings},
                        {"inspection_error", r.options.each.inspection.error},
                        {"cost_bound", r.cost_bound},
                        {"cost_untold", r.cost_untold},
                        {"cost_unshared", r.cost_unshared},
                        {"floor_checked", r.options.worst_stops},
                        {"all_met", r.all_met()}};
    auto policies = settings::Json::array();
    const std::vector<bool> possible = r.feasible();
    for (const PolicyLives& p : r.policies) {
        const Summary s = regulation::summary(p, possible, r.plan.tolerance);
        settings::Json one{{"name", p.policy.name},
                           {"feasible", s.feasible},
                           {"met", s.met},
                           {"together", s.together},
                           {"first_limit_landing", s.first_landing},
                           {"other_left", s.other_left},
                           {"worst_other_left", s.worst_other_left},
                           {"brake_used_at_plan", s.brake_at_plan},
                           {"tyre_used_at_plan", s.tyre_at_plan},
                           {"cost", s.cost},
                           {"cost_above_bound", s.loss},
                           {"j_mu", s.j_mu},
                           {"min_j_mu", s.min_j_mu},
                           {"distance_m", s.distance_m}};
        if (p.policy.fixed) one["slip_reference"] = *p.policy.fixed;
        auto lives = settings::Json::array();
        for (const Life& life : p.lives) lives.push_back(life_json(life));
        one["lives"] = std::move(lives);
        policies.push_back(std::move(one));
    }
    json["policies"] = std::move(policies);
    return settings::json_page(json);
}

std::string to_csv(const RegulateReport& r) {
    auto csv = settings::TextTable::csv(
        "policy|life|landing|slip_reference:.6f|required_share:.6f|tyre_share:.6f|brake_J:.1f|tyre_J:.1f|distance_m:.3f|worst_distance_m:.3f|j_mu:."
        "5f|reading");
    for (const PolicyLives& p : r.policies) {
        for (std::size_t i = 0; i < p.lives.size(); ++i) {
            for (std::size_t k = 0; k < p.lives[i].rows.size(); ++k) {
                const LifeRow& row = p.lives[i].rows[k];
                csv.add(p.policy.name, i + 1, k + 1, row.reference, row.required_share, row.share, row.brake_J, row.tyre_J, row.distance_m,
                        row.worst_distance_m, row.j_mu, wear::name(row.reading));
            }
        }
    }
    return csv.text();
}

void draw(const RegulateReport& r, const std::filesystem::path& png) {
    using pictures::Series;
    using pictures::Style;
    const auto planned = static_cast<double>(r.plan.landings);
    const double last = planned * 1.08;
    const auto life = [](const Life& one, std::string name, Style style, pictures::Colour colour, const auto& value) {
        Series s{.name = std::move(name), .style = style, .colour = colour, .width = 2.0};
        for (std::size_t k = 0; k < one.rows.size(); ++k) s.add(static_cast<double>(k + 1), value(one, one.rows[k]));
        return s;
    };
    const auto brake = [](const Life& l, const LifeRow& row) { return row.brake_J / l.brake_budget_J * 100.0; };
    const auto tyre = [](const Life& l, const LifeRow& row) { return row.tyre_J / l.tyre_budget_J * 100.0; };
    const auto& lives = r.policies.front().lives;
    const PolicyLives& fixed = r.policies[shown_fixed(r)];
    const pictures::Chart used{.y_label = "used of what was left (%)",
                               .x_label = "landing",
                               .series = {pictures::level("limit", 0.0, last, 100.0, pictures::grey),
                                          life(lives.front(), "brake, regulated", Style::line, pictures::blue, brake),
                                          life(lives.front(), "tyre, regulated", Style::line, pictures::vermillion, tyre),
                                          life(fixed.lives.front(), "brake, " + fixed.policy.name, Style::dashes, pictures::sky, brake),
                                          life(fixed.lives.front(), "tyre, " + fixed.policy.name, Style::dashes, pictures::orange, tyre)},
                               .x_range = pictures::Range{0.0, last},
                               .y_range = pictures::Range{0.0, 155.0},
                               .marks = {planned}};
    pictures::Chart reference{.y_label = "slip reference",
                              .x_label = "landing",
                              .series = {pictures::level("allowed by the floor on J_mu", 0.0, last, r.range.lowest, pictures::grey),
                                         pictures::level("", 0.0, last, r.range.highest, pictures::grey)},
                              .x_range = pictures::Range{0.0, last},
                              .marks = {planned}};
    for (std::size_t i = lives.size(); i-- > 0;) {
        reference.series.push_back(life(lives[i], i == 0 ? "life 1, as above" : "other lives", Style::line, i == 0 ? pictures::green : pictures::grey,
                                        [](const Life&, const LifeRow& row) { return row.reference; }));
        reference.series.back().in_legend = i < 2;
        reference.series.back().width = i == 0 ? 2.0 : 0.8;
    }
    Series each{.name = "each life", .style = Style::points, .colour = pictures::grey};
    Series means{.name = "mean", .style = Style::points, .colour = pictures::vermillion};
    const auto count = static_cast<double>(r.policies.size());
    for (std::size_t p = 0; p < r.policies.size(); ++p) {
        const double line = count - static_cast<double>(p);
        for (const Life& one : r.policies[p].lives) each.add(one.other_left * 100.0, line);
        means.add(regulation::summary(r.policies[p], r.feasible(), r.plan.tolerance).other_left * 100.0, line + 0.35);
        means.notes.push_back(r.policies[p].policy.name);
    }
    const pictures::Chart policies{.y_label = "policy",
                                   .x_label = "left of the other at the first limit (%)",
                                   .series = {std::move(each), std::move(means)},
                                   .x_range = pictures::Range{-1.0, 101.0},
                                   .y_range = pictures::Range{0.5, count + 1.0}};
    pictures::draw(
        {.title = fmt::format("Brake and tyre used up together: {} {}, seed {}", lives.size(), lives.size() == 1 ? "life" : "lives", r.options.seed),
         .charts = {used, std::move(reference), policies}},
        png);
}

}  // namespace plant_sim::lab
