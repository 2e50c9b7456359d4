#include "plant_sim/study/robust/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/study/order_statistics.hpp"
#include "plant_sim/study/robust/brake_on_report.hpp"
#include "plant_sim/study/robust/changes_report.hpp"
#include "rig_bridge/pictures/figure.hpp"

namespace robust {

namespace {

constexpr double kLock_s = 0.05;

std::string worst_is(const RobustPlan& plan, const Summary& s) {
    return describe(plan.basis, draw(plan.basis, s.family, plan.seed, s.worst));
}

double distance_m(const DrawnStop& row) {
    return row.figures.standstill ? row.figures.stop_distance_m : std::numeric_limits<double>::infinity();
}

std::optional<std::size_t> told_peak(const RobustPlan& plan) {
    const auto at = std::find_if(plan.laws.begin(), plan.laws.end(), [](const ComparedLaw& law) { return law.name == kToldPeak; });
    if (at == plan.laws.end()) return std::nullopt;
    return static_cast<std::size_t>(at - plan.laws.begin());
}

/// `yardstick`: the law that knows the peak slip.
std::optional<AgainstToldPeak> against(const std::vector<DrawnStop>& rows, const Summary& s, std::size_t yardstick) {
    std::map<std::size_t, double> told_m;  // by draw
    for (const DrawnStop& row : rows)
        if (row.family == s.family && row.law == yardstick && row.figures.standstill) told_m[row.number] = distance_m(row);
    AgainstToldPeak a;
    std::vector<double> ratios;
    for (const DrawnStop& row : rows) {
        if (row.family != s.family || row.law != s.law) continue;
        const auto told = told_m.find(row.number);
        if (told != told_m.end()) ratios.push_back(distance_m(row) / told->second);
    }
    if (ratios.empty()) return std::nullopt;
    std::sort(ratios.begin(), ratios.end());
    a.draws = ratios.size();
    const auto within = std::upper_bound(ratios.begin(), ratios.end(), AgainstToldPeak::kWithin);
    a.within = static_cast<double>(within - ratios.begin()) / static_cast<double>(a.draws);
    a.percentile_90 = study::percentile(ratios, 90);
    a.percentile_99 = study::percentile(ratios, 99);
    const auto rest = std::find_if(ratios.begin(), ratios.end(), [](double r) { return !std::isfinite(r); });
    a.mean = std::accumulate(ratios.begin(), rest, 0.0) / static_cast<double>(rest - ratios.begin());
    return a;
}

std::string ratio(double value) {
    return std::isfinite(value) ? fmt::format("{:.4f}", value) : "no stop";
}

std::vector<DrawnStop> worst_first(const std::vector<DrawnStop>& rows, const Summary& s) {
    std::vector<DrawnStop> own;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(own),
                 [&s](const DrawnStop& row) { return row.family == s.family && row.law == s.law; });
    std::stable_sort(own.begin(), own.end(), [](const DrawnStop& a, const DrawnStop& b) { return a.figures.j_mu < b.figures.j_mu; });
    return own;
}

/// J_mu over the share of stops that are not better, and the stops in which the brakes were released.
std::array<pictures::Series, 2> curves(const RobustPlan& plan, const std::vector<DrawnStop>& rows, const Summary& s) {
    const std::vector<DrawnStop> own = worst_first(rows, s);
    pictures::Series all{.name = fmt::format("{}, mean {:.3f}", plan.laws[s.law].name, s.mean_j_mu), .colour = s.law, .width = 2.0};
    pictures::Series released{.name = fmt::format("{} brakes released", s.brakes_released), .style = pictures::Style::points, .colour = s.law};
    all.add(0.0, own.front().figures.j_mu);
    for (std::size_t i = 0; i < own.size(); ++i) {
        const double share = 100.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(own.size());
        all.add(share, own[i].figures.j_mu);
        if (own[i].brakes_released()) released.add(share, own[i].figures.j_mu);
    }
    all.add(100.0, own.back().figures.j_mu);
    return {all, released};
}

}  // namespace

std::vector<Summary> summarise(const RobustPlan& plan, const std::vector<DrawnStop>& rows) {
    std::vector<Summary> all;
    const std::optional<std::size_t> yardstick = told_peak(plan);
    for (const Family family : plan.families) {
        for (std::size_t law = 0; law < plan.laws.size(); ++law) {
            Summary s{.family = family, .law = law, .against_told_peak = {}};
            std::vector<double> j_mu;
            for (const DrawnStop& row : rows) {
                if (row.family != family || row.law != law) continue;
                if (j_mu.empty() || row.figures.j_mu < s.worst_j_mu) {
                    s.worst_j_mu = row.figures.j_mu;
                    s.worst = row.number;
                }
                j_mu.push_back(row.figures.j_mu);
                s.brakes_released += row.brakes_released() ? 1U : 0U;
                s.locked += row.figures.longest_lock_s > kLock_s ? 1U : 0U;
                s.mean_j_mu += row.figures.j_mu;
                s.mean_travel_mAps += row.figures.valve_travel_mAps.value_or(0.0);
            }
            if (j_mu.empty()) continue;
            s.stops = j_mu.size();
            s.mean_j_mu /= static_cast<double>(s.stops);
            s.mean_travel_mAps /= static_cast<double>(s.stops);
            std::sort(j_mu.begin(), j_mu.end());
            s.percentile_j_mu = study::percentile(j_mu, 1);
            if (yardstick && !is_bound(plan.laws[law].name)) s.against_told_peak = against(rows, s, *yardstick);
            all.push_back(s);
        }
    }
    return all;
}

std::string to_table(const RobustPlan& plan, const std::vector<DrawnStop>& rows, const std::vector<Summary>& summaries) {
    const bool told = told_peak(plan).has_value();
    auto table = settings::TextTable::markdown(
        std::string("family|law|stops|brakes released|locked|mean J_mu:.4f|1st percentile:.3f|worst:.3f|valve travel (mA/s):.0f") +
        (told ? "|distance over told_peak's: mean:|90 %|99 %|within 3 %" : ""));
    for (const Summary& s : summaries) {
        table.add(name(s.family), plan.laws[s.law].name, s.stops, s.brakes_released, s.locked, s.mean_j_mu, s.percentile_j_mu, s.worst_j_mu,
                  s.mean_travel_mAps);
        if (const auto& a = s.against_told_peak)
            table.add(ratio(a->mean), ratio(a->percentile_90), ratio(a->percentile_99), fmt::format("{:.1f} % of {}", 100.0 * a->within, a->draws));
        else if (told)
            table.add("not measured", "", "", "");
    }
    for (const Summary& s : summaries)
        table.line(fmt::format("{}, {}: worst: draw {} ({})", name(s.family), plan.laws[s.law].name, s.worst, worst_is(plan, s)));
    return table.text() + changes_table(plan, rows) + brake_on_table(plan, rows);
}

std::string to_json(const RobustPlan& plan, const std::vector<DrawnStop>& rows, const std::vector<Summary>& summaries) {
    settings::Json json;
    json["seed"] = plan.seed;
    json["draws"] = plan.draws;
    json["slip_reference"] = plan.basis.uncertainty.slip_reference;
    json["config_hash"] = plan.config_hash;
    json["version"] = ANTISKID_VERSION;
    json["families"] = settings::Json::array();
    for (const Summary& s : summaries) {
        json["families"].push_back({{"family", name(s.family)},
                                    {"law", plan.laws[s.law].name},
                                    {"stops", s.stops},
                                    {"ended_safe", s.brakes_released},
                                    {"locked", s.locked},
                                    {"mean_j_mu", s.mean_j_mu},
                                    {"percentile_1_j_mu", s.percentile_j_mu},
                                    {"worst_j_mu", s.worst_j_mu},
                                    {"worst_draw", s.worst},
                                    {"worst_is", worst_is(plan, s)},
                                    {"mean_valve_travel_mAps", s.mean_travel_mAps}});
        if (const auto& a = s.against_told_peak)
            json["families"].back()["distance_over_told_peak"] = {{"draws", a->draws},
                                                                  {"mean", a->mean},
                                                                  {"percentile_90", a->percentile_90},
                                                                  {"percentile_99", a->percentile_99},
                                                                  {"within_3_percent", a->within}};
    }
    const auto has = [&](Family family) { return std::find(plan.families.begin(), plan.families.end(), family) != plan.families.end(); };
    if (has(Family::changes)) json["changes"] = changes_json(plan, rows);
    if (has(Family::brake_on)) json["brake_on"] = brake_on_json(plan, rows);
    return settings::json_page(json);
}

std::string to_csv(const RobustPlan& plan, const std::vector<DrawnStop>& rows) {
    auto csv =
        settings::TextTable::csv("family|law|draw|j_mu:.6f|stop_distance_m:.3f|longest_lock_s:.4f|peak_slip:.4f|faults|valve_travel_mAps:.1f|what");
    for (const DrawnStop& row : rows)
        csv.add(name(row.family), plan.laws[row.law].name, row.number, row.figures.j_mu, row.figures.stop_distance_m, row.figures.longest_lock_s,
                row.figures.peak_slip, row.faults.bits(), row.figures.valve_travel_mAps.value_or(0.0),
                "\"" + describe(plan.basis, draw(plan.basis, row.family, plan.seed, row.number)) + "\"");
    return csv.text();
}

void draw_j_mu(const RobustPlan& plan, const std::vector<DrawnStop>& rows, const std::vector<Summary>& summaries, const std::filesystem::path& png) {
    double min = 0.9, max = 1.0;
    for (const DrawnStop& row : rows) {
        min = std::min(min, row.figures.j_mu);
        max = std::max(max, row.figures.j_mu);
    }
    pictures::Figure figure{
        .title = fmt::format("J_mu of every stop, worst first: seed {}, slip reference {}", plan.seed, plan.basis.uncertainty.slip_reference),
        .columns = plan.families.size() > 1 ? 2 : 1};
    for (const Family family : plan.families) {
        pictures::Chart chart{.title = fmt::format("{}, {} stops", name(family), plan.draws_of(family)),
                              .y_label = "J_mu",
                              .x_label = "share of the stops (%)",
                              .x_range = pictures::Range{0.0, 100.0},
                              .y_range = pictures::Range{std::floor(min * 10.0) / 10.0, std::ceil(max * 10.0) / 10.0}};
        for (const Summary& s : summaries) {
            if (s.family != family) continue;
            for (pictures::Series& one : curves(plan, rows, s))
                if (!one.x.empty()) chart.series.push_back(std::move(one));
        }
        figure.charts.push_back(std::move(chart));
    }
    pictures::draw(std::move(figure), png);
}

}  // namespace robust
