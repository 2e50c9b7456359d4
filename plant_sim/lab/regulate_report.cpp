#include "plant_sim/lab/regulate_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "firmware/host/settings/text_table.hpp"
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

nlohmann::ordered_json life_json(const Life& life) {
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

/// Blocks $regulated0 ...: landing, reference, brake and tyre used (%); $p0 ... one line a policy.
std::string data(const RegulateReport& r) {
    std::string out;
    for (std::size_t p = 0; p < r.policies.size(); ++p) {
        const std::size_t lives = p == 0 ? r.policies[p].lives.size() : 1;
        for (std::size_t i = 0; i < lives; ++i) {
            const Life& life = r.policies[p].lives[i];
            std::string rows = "0 NaN 0 0\n";
            for (std::size_t k = 0; k < life.rows.size(); ++k)
                fmt::format_to(std::back_inserter(rows), "{} {:.5f} {:.4f} {:.4f}\n", k + 1, life.rows[k].reference,
                               life.rows[k].brake_J / life.brake_budget_J * 100.0, life.rows[k].tyre_J / life.tyre_budget_J * 100.0);
            out += pictures::gnuplot_block(fmt::format("life{}_{}", p, i), rows);
        }
        std::string rows;
        for (const Life& life : r.policies[p].lives)
            fmt::format_to(std::back_inserter(rows), "{:.3f} {:.4f} {:.4f}\n", static_cast<double>(p), life.brake_at_plan * 100.0,
                           life.tyre_at_plan * 100.0);
        out += pictures::gnuplot_block(fmt::format("policy{}", p), rows);
    }
    return out;
}

/// The fixed reference that the energies are shown against: the paper's, or the first there is.
std::size_t shown_fixed(const RegulateReport& r) {
    for (std::size_t p = 1; p < r.policies.size(); ++p) {
        if (r.policies[p].policy.fixed == r.rules.default_reference) return p;
    }
    return 1;
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
        "policy|met, of feasible lives|together, of all lives|first limit at landing:.1f|left of the other: mean:|worst|brake used at plan|tyre used "
        "at plan|mean J_mu:.4f|least J_mu:.3f|mean distance (m):.1f");
    const auto percent = [](double share, int digits) { return fmt::format("{:.{}f} %", share * 100.0, digits); };
    const std::vector<bool> possible = r.feasible();
    for (const PolicyLives& p : r.policies) {
        const Summary s = regulation::summary(p, possible, r.plan.tolerance);
        table.add(p.policy.name, fmt::format("{} of {}", s.met, s.feasible), fmt::format("{} of {}", s.together, p.lives.size()), s.first_landing,
                  percent(s.other_left, 2), percent(s.worst_other_left, 2), percent(s.brake_at_plan, 1), percent(s.tyre_at_plan, 1), s.j_mu,
                  s.min_j_mu, s.distance_m);
    }
    text += "\n" + table.text();
    const Summary s = regulation::summary(regulated, possible, r.plan.tolerance);
    fmt::format_to(std::back_inserter(text), "\n{}\n",
                   !r.options.worst_stops ? "stop distances were not checked against the floor"
                   : s.floor_held         ? "no regulated stop was longer than at the worst reference that the floor allows"
                                          : "A REGULATED STOP WAS LONGER than at the worst reference that the floor allows");
    return text;
}

std::string to_json(const RegulateReport& r) {
    nlohmann::ordered_json json{{"study", "regulate"},
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
                                {"brake_deviation", r.options.brake_deviation},
                                {"inspection_landings", r.options.inspection},
                                {"forecast", r.options.life_forecast.has_value() && r.options.inspection == 0},
                                {"floor_checked", r.options.worst_stops},
                                {"all_met", r.all_met()}};
    auto policies = nlohmann::ordered_json::array();
    const std::vector<bool> possible = r.feasible();
    for (const PolicyLives& p : r.policies) {
        const Summary s = regulation::summary(p, possible, r.plan.tolerance);
        nlohmann::ordered_json one{{"name", p.policy.name},
                                   {"feasible", s.feasible},
                                   {"met", s.met},
                                   {"together", s.together},
                                   {"first_limit_landing", s.first_landing},
                                   {"other_left", s.other_left},
                                   {"worst_other_left", s.worst_other_left},
                                   {"brake_used_at_plan", s.brake_at_plan},
                                   {"tyre_used_at_plan", s.tyre_at_plan},
                                   {"j_mu", s.j_mu},
                                   {"min_j_mu", s.min_j_mu},
                                   {"distance_m", s.distance_m}};
        if (p.policy.fixed) one["slip_reference"] = *p.policy.fixed;
        auto lives = nlohmann::ordered_json::array();
        for (const Life& life : p.lives) lives.push_back(life_json(life));
        one["lives"] = std::move(lives);
        policies.push_back(std::move(one));
    }
    json["policies"] = std::move(policies);
    return json.dump(2) + "\n";
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
    const std::size_t fixed = shown_fixed(r);
    const std::size_t lives = r.policies.front().lives.size();
    std::string script = data(r);
    auto out = std::back_inserter(script);
    fmt::format_to(out, R"(set lmargin 10
set rmargin 3
set multiplot layout 3,1 title {title} noenhanced
set xrange [0:{most}]
set arrow 1 from {planned}, graph 0 to {planned}, graph 1 nohead dt 3 lc rgb '#555555'
set ylabel 'used of what was left (%)'
set yrange [0:155]
set key top left
plot 100 with lines lc rgb '#555555' dt 2 title 'limit', \
     $life0_0 using 1:3 with lines lw 2.5 lc rgb '#1f4e79' title 'brake, regulated', \
     $life0_0 using 1:4 with lines lw 2.5 lc rgb '#c55a11' title 'tyre, regulated', \
     $life{fixed}_0 using 1:3 with lines lw 1.2 dt 4 lc rgb '#1f4e79' title 'brake, {fixed_name}' noenhanced, \
     $life{fixed}_0 using 1:4 with lines lw 1.2 dt 4 lc rgb '#c55a11' title 'tyre, {fixed_name}' noenhanced
set xlabel 'landing'
set ylabel 'slip reference'
set yrange [{low}:{high}]
set key bottom right
plot {lowest} with lines lc rgb '#555555' dt 2 title 'allowed by the floor on J_{{/Symbol m}}', \
     {highest} with lines lc rgb '#555555' dt 2 notitle)",
                   fmt::arg("title", pictures::gnuplot_quoted(fmt::format("Brake and tyre used up together: {} {}, seed {}", lives,
                                                                          lives == 1 ? "life" : "lives", r.options.seed))),
                   fmt::arg("most", static_cast<double>(r.plan.landings) * 1.08), fmt::arg("planned", r.plan.landings), fmt::arg("fixed", fixed),
                   fmt::arg("fixed_name", r.policies[fixed].policy.name), fmt::arg("low", r.range.lowest - 0.10),
                   fmt::arg("high", r.range.highest + 0.03), fmt::arg("lowest", r.range.lowest), fmt::arg("highest", r.range.highest));
    for (std::size_t i = lives; i-- > 0;)
        fmt::format_to(out, ", \\\n     $life0_{} using 1:2 with lines lw {} lc rgb '{}' title '{}'", i, i == 0 ? 2.5 : 0.8,
                       i == 0 ? "#548235" : "#a9c98f", i == 0 ? "life 1, as above" : (i == 1 ? "other lives" : ""));
    fmt::format_to(out, R"(
unset arrow 1
set xlabel ''
set xrange [-0.6:{last}]
set yrange [*:*]
set offsets 0, 0, graph 0.15, graph 0.05
set ylabel 'used at the planned landing (%)'
set key top left
set xtics ({tics}) noenhanced
plot {above} with lines lc rgb '#555555' dt 3 title 'plan, within {tolerance} %', {below} with lines lc rgb '#555555' dt 3 notitle)",
                   fmt::arg("last", static_cast<double>(r.policies.size()) - 0.4),
                   fmt::arg("tics",
                            [&] {
                                std::string tics;
                                for (std::size_t p = 0; p < r.policies.size(); ++p)
                                    fmt::format_to(std::back_inserter(tics), "{}{} {}", p == 0 ? "" : ", ",
                                                   pictures::gnuplot_quoted(r.policies[p].policy.name), p);
                                return tics;
                            }()),
                   fmt::arg("above", 100.0 * (1.0 + r.plan.tolerance)), fmt::arg("below", 100.0 * (1.0 - r.plan.tolerance)),
                   fmt::arg("tolerance", 100.0 * r.plan.tolerance));
    for (std::size_t p = 0; p < r.policies.size(); ++p)
        fmt::format_to(out,
                       ", \\\n     $policy{0} using ($1-0.08):2 with points pt 7 ps 0.9 lc rgb '#1f4e79' {1}, \\\n"
                       "     $policy{0} using ($1+0.08):3 with points pt 9 ps 0.9 lc rgb '#c55a11' {2}",
                       p, p == 0 ? "title 'brake, each life'" : "notitle", p == 0 ? "title 'tyre, each life'" : "notitle");
    script += "\nunset multiplot\n";
    pictures::run_gnuplot(png, 1100, 1200, script);
}

}  // namespace plant_sim::lab
