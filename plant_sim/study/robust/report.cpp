#include "plant_sim/study/robust/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

namespace robust {

namespace {

constexpr double kLock_s = 0.05;

std::string worst_is(const Plan& plan, const Summary& s) {
    return describe(plan.basis, draw(plan.basis, s.family, plan.seed, s.worst));
}

}  // namespace

std::vector<Summary> summarise(const Plan& plan, const std::vector<Row>& rows) {
    std::vector<Summary> all;
    for (const Family family : plan.families) {
        for (std::size_t law = 0; law < plan.laws.size(); ++law) {
            Summary s{.family = family, .law = law};
            std::vector<double> j_mu;
            for (const Row& row : rows) {
                if (row.family != family || row.law != law) continue;
                if (j_mu.empty() || row.figures.j_mu < s.worst_j_mu) {
                    s.worst_j_mu = row.figures.j_mu;
                    s.worst = row.number;
                }
                j_mu.push_back(row.figures.j_mu);
                s.tripped += row.tripped() ? 1U : 0U;
                s.locked += row.figures.longest_lock_s > kLock_s ? 1U : 0U;
                s.mean_j_mu += row.figures.j_mu;
                s.mean_travel_mAps += row.travel_mAps;
            }
            if (j_mu.empty()) continue;
            s.stops = j_mu.size();
            s.mean_j_mu /= static_cast<double>(s.stops);
            s.mean_travel_mAps /= static_cast<double>(s.stops);
            std::sort(j_mu.begin(), j_mu.end());
            s.percentile_j_mu = j_mu[(s.stops - 1) / 100];
            all.push_back(s);
        }
    }
    return all;
}

std::string to_table(const Plan& plan, const std::vector<Summary>& summaries) {
    std::string text =
        "| family | law | stops | ended safe | locked | mean J_mu | 1st percentile | worst | valve travel "
        "(mA/s) |\n|---|---|---|---|---|---|---|---|---|\n";
    for (const Summary& s : summaries)
        fmt::format_to(std::back_inserter(text),
                       "| {} | {} | {} | {} | {} | {:.4f} | {:.3f} | {:.3f} | {:.0f} |\n", name(s.family),
                       plan.law_names[s.law], s.stops, s.tripped, s.locked, s.mean_j_mu, s.percentile_j_mu,
                       s.worst_j_mu, s.mean_travel_mAps);
    for (const Summary& s : summaries)
        fmt::format_to(std::back_inserter(text), "{}, {}: worst: draw {} ({})\n", name(s.family),
                       plan.law_names[s.law], s.worst, worst_is(plan, s));
    return text;
}

std::string to_json(const Plan& plan, const std::vector<Summary>& summaries) {
    nlohmann::ordered_json json;
    json["seed"] = plan.seed;
    json["draws"] = plan.draws;
    json["slip_reference"] = plan.basis.uncertainty.slip_reference;
    json["config_hash"] = plan.config_hash;
    json["version"] = ANTISKID_VERSION;
    json["families"] = nlohmann::ordered_json::array();
    for (const Summary& s : summaries)
        json["families"].push_back({{"family", name(s.family)},
                                    {"law", plan.law_names[s.law]},
                                    {"stops", s.stops},
                                    {"ended_safe", s.tripped},
                                    {"locked", s.locked},
                                    {"mean_j_mu", s.mean_j_mu},
                                    {"percentile_1_j_mu", s.percentile_j_mu},
                                    {"worst_j_mu", s.worst_j_mu},
                                    {"worst_draw", s.worst},
                                    {"worst_is", worst_is(plan, s)},
                                    {"mean_valve_travel_mAps", s.mean_travel_mAps}});
    return json.dump(2) + "\n";
}

std::string to_csv(const Plan& plan, const std::vector<Row>& rows) {
    std::string text =
        "family,law,draw,j_mu,stop_distance_m,longest_lock_s,peak_slip,faults,valve_travel_mAps,what\n";
    for (const Row& row : rows)
        fmt::format_to(std::back_inserter(text), "{},{},{},{:.6f},{:.3f},{:.4f},{:.4f},{},{:.1f},\"{}\"\n",
                       name(row.family), plan.law_names[row.law], row.number, row.figures.j_mu,
                       row.figures.stop_distance_m, row.figures.longest_lock_s, row.figures.peak_slip,
                       row.faults.bits(), row.travel_mAps,
                       describe(plan.basis, draw(plan.basis, row.family, plan.seed, row.number)));
    return text;
}

}  // namespace robust
