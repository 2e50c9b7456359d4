/// What the stops of the grid `changes` came to: how soon the wheel has the friction of another surface.
#pragma once

#include <string>
#include <vector>

#include "firmware/host/settings/json.hpp"
#include "plant_sim/study/robust/robust_campaign.hpp"

namespace robust {

/// Of one law: all changes, those at one speed, or those to one surface.
struct ChangesSummary {
    std::size_t law = 0;
    std::string of;
    std::size_t changes = 0;
    std::size_t measured = 0;  ///< Regrip::measured(); the rest counts nowhere below
    std::size_t in_time = 0;   ///< regained within 0.4 s
    std::size_t never = 0;     ///< not regained while it was looked at
    // By nearest rank; infinite where that one was never regained. Of no meaning where none was measured.
    double median_s = 0.0;
    double percentile_90_s = 0.0;
    double worst_s = 0.0;
    std::size_t worst = 0;  ///< number of its stop
};

[[nodiscard]] std::vector<ChangesSummary> summarise_changes(const RobustPlan& plan, const std::vector<Row>& rows);

/// In Markdown; empty where the plan has no changes.
[[nodiscard]] std::string changes_table(const RobustPlan& plan, const std::vector<Row>& rows);
/// The summaries, and every change by itself.
[[nodiscard]] settings::Json changes_json(const RobustPlan& plan, const std::vector<Row>& rows);

}  // namespace robust
