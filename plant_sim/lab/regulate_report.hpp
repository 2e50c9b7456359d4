/// Output of `rig-lab regulate`: table, results.json, landings.csv, regulate.png.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plant_sim/study/regulation/lives.hpp"
#include "rig_bridge/wear/limit_forecast.hpp"

namespace plant_sim::lab {

struct RegulateReport {
    wear::WearPlan plan;
    wear::Rules rules;
    wear::Range range;
    wear::LimitForecast limits;  ///< at the beginning of the plan
    regulation::LivesOptions options;
    std::vector<regulation::PolicyLives> policies;  ///< the regulated one first
    double cost_bound = 0.0, cost_untold = 0.0,
           cost_unshared = 0.0;  ///< money per landing: Bound with the surface known, and unknown; cost_unshared()
    std::string config_hash;

    [[nodiscard]] std::vector<bool> feasible() const;  ///< of each life
    [[nodiscard]] bool all_met() const;                ///< whether both limits were met in every feasible life, and the floor was kept
};

[[nodiscard]] std::string to_text(const RegulateReport& report);
[[nodiscard]] std::string to_json(const RegulateReport& report);
/// All landings of all lives under all policies.
[[nodiscard]] std::string to_csv(const RegulateReport& report);
/// Throws std::runtime_error if gnuplot fails.
void draw(const RegulateReport& report, const std::filesystem::path& png);

}  // namespace plant_sim::lab
