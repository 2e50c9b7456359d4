/// Pictures of a campaign and of the mixture fitted to it, by gnuplot; after a failure there is no partial file. All throw std::runtime_error if
/// gnuplot is missing or fails.
#pragma once

#include <filesystem>
#include <vector>

#include "rig_bridge/wear/forecast.hpp"
#include "rig_bridge/wear/health.hpp"
#include "rig_bridge/wear/model.hpp"
#include "rig_bridge/wear/wear_campaign.hpp"

namespace plant_sim::lab {

/// Recorded points, the fan of the brake's mean friction, the limit, and the landings at which it is crossed.
void draw_forecast(const wear::Campaign& recorded, const wear::Forecast& forecast, double limit, const std::filesystem::path& png);

/// Recorded friction with the expected one of each maneuver, and below it the statistic with its limits.
void draw_health(const wear::Campaign& recorded, const std::vector<wear::Verdict>& verdicts, const std::filesystem::path& png);

/// The paper's Fig. 7: friction over energy, with each component's two-sigma ellipse and the mean of eq. (14).
void draw_campaign(const wear::Campaign& campaign, const wear::Model& model, const std::filesystem::path& png);

/// The paper's Fig. 8: contours of the density; each point in the colour of its most likely component.
void draw_density(const wear::Campaign& campaign, const wear::Model& model, const std::filesystem::path& png);

/// The paper's Fig. 9: recorded and simulated friction over energy.
void draw_resimulation(const wear::Campaign& recorded, const wear::Campaign& simulated, const std::filesystem::path& png);

/// BIC over the number of components; the minimum is marked.
void draw_orders(const wear::Model& model, const std::filesystem::path& png);

}  // namespace plant_sim::lab
