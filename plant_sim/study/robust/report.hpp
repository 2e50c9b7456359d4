/// What a campaign on drawn plants came to, per family and law.
#pragma once

#include <string>
#include <vector>

#include "plant_sim/study/robust/campaign.hpp"

namespace robust {

struct Summary {
    Family family{};
    std::size_t law = 0;
    std::size_t stops = 0;
    std::size_t tripped = 0;  ///< ended with a fault, of a plant that has none
    std::size_t locked = 0;   ///< longest lock above 50 ms
    double mean_j_mu = 0.0;
    double percentile_j_mu = 0.0;  ///< the 1st, by order statistics
    double worst_j_mu = 0.0;
    std::size_t worst = 0;  ///< number of its draw
    double mean_travel_mAps = 0.0;
};

/// In the order of the plan. Families without rows are left out.
[[nodiscard]] std::vector<Summary> summarise(const Plan& plan, const std::vector<Row>& rows);

/// In Markdown, and below it a line for each worst stop with what was drawn for it.
[[nodiscard]] std::string to_table(const Plan& plan, const std::vector<Summary>& summaries);
[[nodiscard]] std::string to_json(const Plan& plan, const std::vector<Summary>& summaries);
[[nodiscard]] std::string to_csv(const Plan& plan, const std::vector<Row>& rows);

}  // namespace robust
