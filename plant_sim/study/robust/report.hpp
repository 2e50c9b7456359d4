/// Results of a campaign on drawn plants, by family and law.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "plant_sim/study/robust/robust_campaign.hpp"

namespace robust {

/// Ratios of stop distances to those of told_peak on the same draws.
struct AgainstToldPeak {
    std::size_t draws = 0;  ///< number on which told_peak came to rest
    double mean = 0.0;      ///< over the draws on which both came to rest
    // By nearest rank; infinite if that stop did not come to rest.
    double percentile_90 = 0.0;
    double percentile_99 = 0.0;
    double within = 0.0;  ///< share of the draws with a ratio of at most kWithin
    static constexpr double kWithin = 1.03;
};

struct Summary {
    Family family{};
    std::size_t law = 0;
    std::size_t stops = 0;
    std::size_t brakes_released = 0;  ///< number of stops with DrawnStop::brakes_released()
    std::size_t locked = 0;           ///< longest lock above 50 ms
    double mean_j_mu = 0.0;
    double percentile_j_mu = 0.0;  ///< 1st percentile by nearest rank
    double worst_j_mu = 0.0;
    std::size_t worst = 0;  ///< number of its draw
    double mean_travel_mAps = 0.0;
    std::optional<AgainstToldPeak> against_told_peak;  ///< none: told_peak is not among the laws
};

/// In the order of the plan, without families that have no rows.
[[nodiscard]] std::vector<Summary> summarise(const RobustPlan& plan, const std::vector<DrawnStop>& rows);

/// Markdown; then a line for each worst stop with its draw, and the tables of the grids.
[[nodiscard]] std::string to_table(const RobustPlan& plan, const std::vector<DrawnStop>& rows, const std::vector<Summary>& summaries);
[[nodiscard]] std::string to_json(const RobustPlan& plan, const std::vector<DrawnStop>& rows, const std::vector<Summary>& summaries);
[[nodiscard]] std::string to_csv(const RobustPlan& plan, const std::vector<DrawnStop>& rows);

/// One panel per family, one line per law: J_mu of every stop in ascending order, with crosses for those with the brakes released. Throws
/// std::runtime_error as pictures::run_gnuplot.
void draw_j_mu(const RobustPlan& plan, const std::vector<DrawnStop>& rows, const std::vector<Summary>& summaries, const std::filesystem::path& png);

}  // namespace robust
