/// What a campaign on drawn plants came to, per family and law.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "plant_sim/study/robust/robust_campaign.hpp"

namespace robust {

/// Stop distances as ratios to those of told_peak on the same draws.
struct AgainstToldPeak {
    std::size_t draws = 0;  ///< on which told_peak came to rest
    double mean = 0.0;      ///< of those on which both did
    // By nearest rank; infinite where that stop did not come to rest.
    double percentile_90 = 0.0;
    double percentile_99 = 0.0;
    double within = 0.0;  ///< share of the draws with a ratio of at most kWithin
    static constexpr double kWithin = 1.03;
};

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
    std::optional<AgainstToldPeak> against_told_peak;  ///< where that is among the laws
};

/// In the order of the plan. Families without rows are left out.
[[nodiscard]] std::vector<Summary> summarise(const RobustPlan& plan, const std::vector<Row>& rows);

/// In Markdown, below it a line for each worst stop with what was drawn for it, and the tables of the grids.
[[nodiscard]] std::string to_table(const RobustPlan& plan, const std::vector<Row>& rows, const std::vector<Summary>& summaries);
[[nodiscard]] std::string to_json(const RobustPlan& plan, const std::vector<Row>& rows, const std::vector<Summary>& summaries);
[[nodiscard]] std::string to_csv(const RobustPlan& plan, const std::vector<Row>& rows);

/// A panel a family, a line a law: J_mu of every stop, worst first, with crosses at those that ended safe. Throws std::runtime_error as
/// pictures::run_gnuplot.
void draw_j_mu(const RobustPlan& plan, const std::vector<Row>& rows, const std::vector<Summary>& summaries, const std::filesystem::path& png);

}  // namespace robust
