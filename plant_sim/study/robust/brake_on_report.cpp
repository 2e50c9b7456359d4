#include "plant_sim/study/robust/brake_on_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/study/json_number.hpp"
#include "plant_sim/study/robust/grids.hpp"
#include "plant_sim/study/robust/held_reference.hpp"

namespace robust {

namespace {

double travel_mAps(const DrawnStop& row) {
    return row.figures.valve_travel_mAps.value_or(0.0);
}

std::string stop_is(const RobustPlan& plan, std::size_t number) {
    const NominalLanding& landing = plan.basis.landings[brake_on_at(plan.basis, number).landing];
    return landing.surface + ", " + landing.maneuver;
}

BrakeOnSummary stops_at(const RobustPlan& plan, const std::vector<DrawnStop>& rows, std::size_t law, double speed_mps) {
    BrakeOnSummary s{.law = law, .speed_mps = speed_mps, .mean_share = {}, .min_share = {}};
    double shares = 0.0;
    for (const DrawnStop& row : rows) {
        if (row.family != Family::brake_on || row.law != law || brake_on_at(plan.basis, row.number).speed_mps != speed_mps) continue;
        ++s.stops;
        s.brakes_released += row.brakes_released() ? 1U : 0U;
        s.mean_j_mu += row.figures.j_mu;
        s.mean_travel_mAps += travel_mAps(row);
        const BrakeOnShare of = share_of(plan, rows, row);
        if (of.travel_ratio > s.max_travel_ratio) {
            s.max_travel_ratio = of.travel_ratio;
            s.max = row.number;
        }
        if (!of.held_j_mu) continue;
        const double share = row.figures.j_mu / *of.held_j_mu;
        shares += share;
        s.reached += share >= asked_share(speed_mps) ? 1U : 0U;
        if (!s.min_share || share < *s.min_share) {
            s.min_share = share;
            s.min = row.number;
        }
    }
    if (s.stops == 0) return s;
    s.mean_j_mu /= static_cast<double>(s.stops);
    s.mean_travel_mAps /= static_cast<double>(s.stops);
    if (s.min_share) s.mean_share = shares / static_cast<double>(s.stops);
    return s;
}

}  // namespace

double asked_share(double speed_mps) {
    constexpr double kSlow_mps = 16.6;
    return speed_mps < kSlow_mps ? 0.87 : 0.93;
}

BrakeOnShare share_of(const RobustPlan& plan, const std::vector<DrawnStop>& rows, const DrawnStop& row) {
    const BrakeOn at = brake_on_at(plan.basis, row.number);
    const rig::RigParameters rig = grid_stop(plan.basis, Family::brake_on, row.number).rig;
    BrakeOnShare share;
    if (const auto slip = held_slip(plan, plan.laws[row.law], rig.surface))
        share.held_j_mu = held_j_mu(rig, plan.controller.slip, *slip, plan.drop_out_mps);
    const auto fastest = std::find_if(rows.begin(), rows.end(), [&](const DrawnStop& other) {
        const BrakeOn stop = brake_on_at(plan.basis, other.number);
        return other.family == Family::brake_on && other.law == row.law && stop.landing == at.landing &&
               stop.speed_mps == plan.basis.uncertainty.brake_on_mps.back();
    });
    if (fastest != rows.end() && travel_mAps(*fastest) > 0.0) share.travel_ratio = travel_mAps(row) / travel_mAps(*fastest);
    return share;
}

std::vector<BrakeOnSummary> summarise_brake_on(const RobustPlan& plan, const std::vector<DrawnStop>& rows) {
    std::vector<BrakeOnSummary> all;
    if (std::find(plan.families.begin(), plan.families.end(), Family::brake_on) == plan.families.end()) return all;
    for (std::size_t law = 0; law < plan.laws.size(); ++law)
        for (const double speed_mps : plan.basis.uncertainty.brake_on_mps) all.push_back(stops_at(plan, rows, law, speed_mps));
    return all;
}

std::string brake_on_table(const RobustPlan& plan, const std::vector<DrawnStop>& rows) {
    const std::vector<BrakeOnSummary> all = summarise_brake_on(plan, rows);
    if (all.empty()) return {};
    auto table = settings::TextTable::markdown(
        "law|brake-on (m/s):.1f|brakes released|mean J_mu:.4f|mean share:.3f|least share|at least as asked|valve travel (mA/s):.0f|most over the "
        "fastest's");
    for (const BrakeOnSummary& s : all) {
        table.add(plan.laws[s.law].name, s.speed_mps, s.brakes_released, s.mean_j_mu);
        if (s.min_share)
            table.add(*s.mean_share, fmt::format("{:.3f}: {}", *s.min_share, stop_is(plan, s.min)),
                      fmt::format("{} of {} at {:.2f}", s.reached, s.stops, asked_share(s.speed_mps)));
        else
            table.add("none is held", "", "");
        table.add(s.mean_travel_mAps, fmt::format("{:.1f}: {}", s.max_travel_ratio, stop_is(plan, s.max)));
    }
    return "\nJ_mu over that of the reference held exactly, and valve travel over that of the fastest brake-on\n\n" + table.text();
}

settings::Json brake_on_json(const RobustPlan& plan, const std::vector<DrawnStop>& rows) {
    settings::Json json{{"required_travel_ratio", kRequiredTravelRatio}, {"summaries", settings::Json::array()}, {"stops", settings::Json::array()}};
    for (const BrakeOnSummary& s : summarise_brake_on(plan, rows))
        json["summaries"].push_back({{"law", plan.laws[s.law].name},
                                     {"speed_mps", s.speed_mps},
                                     {"stops", s.stops},
                                     {"ended_safe", s.brakes_released},
                                     {"mean_j_mu", s.mean_j_mu},
                                     {"asked_share_of_held", asked_share(s.speed_mps)},
                                     {"mean_share_of_held", study::or_null(s.mean_share)},
                                     {"min_share_of_held", study::or_null(s.min_share)},
                                     {"min_is", s.min_share ? settings::Json(stop_is(plan, s.min)) : settings::Json()},
                                     {"reached", s.reached},
                                     {"mean_valve_travel_mAps", s.mean_travel_mAps},
                                     {"max_travel_ratio", s.max_travel_ratio},
                                     {"max_travel_is", stop_is(plan, s.max)}});
    for (const DrawnStop& row : rows) {
        if (row.family != Family::brake_on) continue;
        const BrakeOn at = brake_on_at(plan.basis, row.number);
        const BrakeOnShare share = share_of(plan, rows, row);
        json["stops"].push_back({{"law", plan.laws[row.law].name},
                                 {"surface", plan.basis.landings[at.landing].surface},
                                 {"maneuver", plan.basis.landings[at.landing].maneuver},
                                 {"speed_mps", at.speed_mps},
                                 {"ended_safe", row.brakes_released()},
                                 {"j_mu", row.figures.j_mu},
                                 {"held_j_mu", study::or_null(share.held_j_mu)},
                                 {"valve_travel_mAps", study::or_null(row.figures.valve_travel_mAps)},
                                 {"travel_ratio", share.travel_ratio}});
    }
    return json;
}

}  // namespace robust
