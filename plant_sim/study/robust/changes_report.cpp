#include "plant_sim/study/robust/changes_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/study/json_number.hpp"
#include "plant_sim/study/order_statistics.hpp"
#include "plant_sim/study/robust/grids.hpp"

namespace robust {

namespace {

constexpr double kNever_s = std::numeric_limits<double>::infinity();

struct Group {
    std::string of;
    std::function<bool(const SurfaceChange&)> has;
};

std::vector<Group> groups_of(const RobustPlan& plan) {
    std::vector<Group> groups{{"all", [](const SurfaceChange&) { return true; }}};
    for (const double speed_mps : plan.basis.uncertainty.change_mps)
        groups.push_back({fmt::format("at {:.0f} m/s", speed_mps), [speed_mps](const SurfaceChange& c) { return c.speed_mps == speed_mps; }});
    for (const NominalLanding& landing : plan.basis.landings) {
        const std::string of = "to " + landing.surface;
        if (std::any_of(groups.begin(), groups.end(), [&](const Group& g) { return g.of == of; })) continue;
        groups.push_back({of, [&plan, &landing](const SurfaceChange& c) { return plan.basis.landings[c.to].surface == landing.surface; }});
    }
    return groups;
}

double regained_s(const Regrip& regrip) {
    return regrip.regained_s.value_or(kNever_s);
}

ChangesSummary changes_of(const RobustPlan& plan, const std::vector<DrawnStop>& rows, std::size_t law, const Group& group) {
    ChangesSummary s{.law = law, .of = group.of};
    std::vector<double> times_s;
    for (const DrawnStop& row : rows) {
        if (row.family != Family::changes || row.law != law || !group.has(change_at(plan.basis, row.number))) continue;
        ++s.changes;
        if (!row.regrip || !row.regrip->measured()) continue;
        const double time_s = regained_s(*row.regrip);
        if (times_s.empty() || time_s > s.worst_s) {
            s.worst_s = time_s;
            s.worst = row.number;
        }
        times_s.push_back(time_s);
        s.in_time += time_s <= Regrip::kRequired_s ? 1U : 0U;
        s.never += time_s == kNever_s ? 1U : 0U;
    }
    s.measured = times_s.size();
    if (times_s.empty()) return s;
    std::sort(times_s.begin(), times_s.end());
    s.median_s = study::percentile(times_s, 50);
    s.percentile_90_s = study::percentile(times_s, 90);
    return s;
}

std::string seconds(double time_s) {
    return std::isfinite(time_s) ? fmt::format("{:.3f}", time_s) : "never";
}

std::string change_is(const RobustPlan& plan, std::size_t number) {
    const SurfaceChange change = change_at(plan.basis, number);
    const NominalLanding& from = plan.basis.landings[change.from];
    return fmt::format("{} to {}, {}, {:.0f} m/s", from.surface, plan.basis.landings[change.to].surface, from.maneuver, change.speed_mps);
}

settings::Json summary_json(const RobustPlan& plan, const ChangesSummary& s) {
    settings::Json json{{"law", plan.laws[s.law].name}, {"of", s.of}, {"changes", s.changes}, {"measured", s.measured}};
    if (s.measured == 0) return json;
    json["within_0.4_s"] = s.in_time;
    json["never"] = s.never;
    json["median_s"] = s.median_s;
    json["percentile_90_s"] = s.percentile_90_s;
    json["worst_s"] = s.worst_s;
    json["worst_is"] = change_is(plan, s.worst);
    return json;
}

}  // namespace

std::vector<ChangesSummary> summarise_changes(const RobustPlan& plan, const std::vector<DrawnStop>& rows) {
    std::vector<ChangesSummary> all;
    if (std::find(plan.families.begin(), plan.families.end(), Family::changes) == plan.families.end()) return all;
    const std::vector<Group> groups = groups_of(plan);
    for (std::size_t law = 0; law < plan.laws.size(); ++law)
        for (const Group& group : groups) all.push_back(changes_of(plan, rows, law, group));
    return all;
}

std::string changes_table(const RobustPlan& plan, const std::vector<DrawnStop>& rows) {
    const std::vector<ChangesSummary> all = summarise_changes(plan, rows);
    if (all.empty()) return {};
    auto table = settings::TextTable::markdown("law|changes|measured|within 0.4 s|median (s)|90 % (s)|never|worst (s)");
    for (const ChangesSummary& s : all) {
        table.add(plan.laws[s.law].name, s.of, fmt::format("{} of {}", s.measured, s.changes));
        if (s.measured == 0)
            table.add("not measured", "", "", "", "");
        else
            table.add(fmt::format("{:.1f} %", 100.0 * static_cast<double>(s.in_time) / static_cast<double>(s.measured)), seconds(s.median_s),
                      seconds(s.percentile_90_s), s.never, seconds(s.worst_s) + ": " + change_is(plan, s.worst));
    }
    return "\n95 % of the new surface's friction, regained and kept after a change of surface\n\n" + table.text();
}

settings::Json changes_json(const RobustPlan& plan, const std::vector<DrawnStop>& rows) {
    settings::Json json{{"summaries", settings::Json::array()}, {"changes", settings::Json::array()}};
    for (const ChangesSummary& s : summarise_changes(plan, rows)) json["summaries"].push_back(summary_json(plan, s));
    for (const DrawnStop& row : rows) {
        if (row.family != Family::changes) continue;
        const SurfaceChange change = change_at(plan.basis, row.number);
        settings::Json one{{"law", plan.laws[row.law].name},
                           {"from", plan.basis.landings[change.from].surface},
                           {"to", plan.basis.landings[change.to].surface},
                           {"maneuver", plan.basis.landings[change.from].maneuver},
                           {"grid_speed_mps", change.speed_mps},
                           {"measured", row.regrip && row.regrip->measured()},
                           {"ended_safe", row.brakes_released()}};
        if (row.regrip) {
            one["speed_mps"] = row.regrip->speed_mps;
            one["judged_s"] = row.regrip->judged_s;
            one["regained_s"] = study::or_null(row.regrip->regained_s);
        }
        json["changes"].push_back(one);
    }
    return json;
}

}  // namespace robust
