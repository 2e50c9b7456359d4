/// Results of the grid `brake_on`: friction relative to that of the reference held exactly, valve travel relative to that of the fastest landing.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/host/settings/json.hpp"
#include "plant_sim/study/robust/robust_campaign.hpp"

namespace robust {

/// One stop relative to its references.
struct BrakeOnShare {
    std::optional<double> held_j_mu;  ///< see held_reference.hpp; none: the law holds no slip
    double travel_ratio = 0.0;        ///< valve travel over that of the fastest brake-on of the same landing and law
};
[[nodiscard]] BrakeOnShare share_of(const RobustPlan& plan, const std::vector<DrawnStop>& rows, const DrawnStop& row);

/// Summary of one law at one speed.
struct BrakeOnSummary {
    std::size_t law = 0;
    double speed_mps = 0.0;
    std::size_t stops = 0;
    std::size_t brakes_released = 0;
    double mean_j_mu = 0.0;
    // J_mu over that of the held reference; none: the law holds no slip.
    std::optional<double> mean_share, min_share;
    std::size_t min = 0;      ///< number of the stop with `min_share`
    std::size_t reached = 0;  ///< number of stops with the required share
    double mean_travel_mAps = 0.0;
    double max_travel_ratio = 0.0;
    std::size_t max = 0;  ///< number of the stop with `max_travel_ratio`
};

/// Required J_mu over that of the held reference: 0.93, below 16.6 m/s 0.87. Largest allowed valve travel over that of the fastest landing: 3.
[[nodiscard]] double asked_share(double speed_mps);
inline constexpr double kRequiredTravelRatio = 3.0;

[[nodiscard]] std::vector<BrakeOnSummary> summarise_brake_on(const RobustPlan& plan, const std::vector<DrawnStop>& rows);

/// Markdown; empty if the plan has no such stops.
[[nodiscard]] std::string brake_on_table(const RobustPlan& plan, const std::vector<DrawnStop>& rows);
/// The summaries, and every stop.
[[nodiscard]] settings::Json brake_on_json(const RobustPlan& plan, const std::vector<DrawnStop>& rows);

}  // namespace robust
