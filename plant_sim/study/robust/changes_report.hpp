/// Results of the grid `changes`: the time until the wheel has the friction of another surface.
#pragma once

#include <string>
#include <vector>

#include "firmware/host/settings/json.hpp"
#include "plant_sim/study/robust/robust_campaign.hpp"

namespace robust {

/// Summary of one law: over all changes, those at one speed, or those to one surface.
struct ChangesSummary {
    std::size_t law = 0;
    std::string of;
    std::size_t changes = 0;
    std::size_t measured = 0;  ///< number with Regrip::measured(); only these count below
    std::size_t in_time = 0;   ///< regained within 0.4 s
    std::size_t never = 0;     ///< not regained during the judged time
    // By nearest rank; infinite if that change was never regained. Meaningless if none was measured.
    double median_s = 0.0;
    double percentile_90_s = 0.0;
    double worst_s = 0.0;
    std::size_t worst = 0;  ///< number of the stop with `worst_s`
};

[[nodiscard]] std::vector<ChangesSummary> summarise_changes(const RobustPlan& plan, const std::vector<DrawnStop>& rows);

/// Markdown; empty if the plan has no changes.
[[nodiscard]] std::string changes_table(const RobustPlan& plan, const std::vector<DrawnStop>& rows);
/// The summaries, and every change.
[[nodiscard]] settings::Json changes_json(const RobustPlan& plan, const std::vector<DrawnStop>& rows);

}  // namespace robust
