/// Pictures of a forecast and of a brake's health, by gnuplot; each is whole or not there. Both throw std::runtime_error when gnuplot is not
/// installed or fails.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rig_bridge/wear/forecast.hpp"
#include "rig_bridge/wear/health.hpp"

namespace plant_sim::lab {

/// Recorded points, the fan of the brake's mean friction, the limit, and where it is crossed.
void draw_forecast(const wear::Campaign& recorded, const wear::Forecast& forecast, double limit, const std::filesystem::path& png);

/// Recorded friction with what was expected of each maneuver, and below it the statistic with its limits.
void draw_health(const wear::Campaign& recorded, const std::vector<wear::Verdict>& verdicts, const std::filesystem::path& png);

}  // namespace plant_sim::lab
