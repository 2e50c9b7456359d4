/// Pictures of a campaign and of the mixture that was fitted to it, by gnuplot; each is whole or not there. All throw std::runtime_error when
/// gnuplot is not installed or fails.
#pragma once

#include <filesystem>

#include "rig_bridge/wear/model.hpp"
#include "rig_bridge/wear/wear_campaign.hpp"

namespace plant_sim::lab {

/// The paper's Fig. 7: friction over energy, with each component's two-sigma ellipse and the mean of eq. (14).
void draw_campaign(const wear::Campaign& campaign, const wear::Model& model, const std::filesystem::path& png);

/// The paper's Fig. 8: contours of the density; each point in the colour of its most likely component.
void draw_density(const wear::Campaign& campaign, const wear::Model& model, const std::filesystem::path& png);

/// The paper's Fig. 9: recorded and simulated friction over energy.
void draw_resimulation(const wear::Campaign& recorded, const wear::Campaign& simulated, const std::filesystem::path& png);

/// BIC over the number of components, least one marked.
void draw_bic(const wear::Model& model, const std::filesystem::path& png);

}  // namespace plant_sim::lab
