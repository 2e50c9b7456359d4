/// Learns a population from the campaigns of several worn-out brakes.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "rig_bridge/wear/population.hpp"

namespace wear {

struct LearnSettings {
    FitSettings fit{.min_components = 1, .max_components = 8, .starts = 10, .seed = 1, .em = {}};
    /// Friction limit of the forecasts; none: chosen between the middle and the end of life. Every brake must have crossed it.
    std::optional<double> limit{};
    /// Campaigns of other brakes, all healthy, from which health limits are learnt: better from 1000 or more of these than from few brakes' own.
    std::vector<Campaign> healthy{};
    unsigned threads = 1;  ///< the result does not depend on it
};

/// Fits a mixture to each campaign; takes memory and size of the scatter from the residuals about the fitted curves; then, each
/// brake given the curves of the others (leave one out): chooses drift and offset so that the maneuvers are as likely as can be, spread of
/// the energy scale and fading of evidence so that the filter's forecasts lose least; curves over the share of life (life_curves.hpp); and health
/// limits, see health_limits.hpp.
/// At least 3 campaigns, else std::invalid_argument; settings::Error where a campaign is refused.
[[nodiscard]] Population learn_population(const std::vector<Campaign>& campaigns, const LearnSettings& settings,
                                          const std::function<void(std::size_t done, std::size_t all)>& progress = {});

}  // namespace wear
