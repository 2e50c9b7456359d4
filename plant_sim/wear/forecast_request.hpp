/// Request and answer of a forecast of landings left, for `rig-lab wear forecast` and the Python module.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/json.hpp"
#include "plant_sim/wear/landing_mix.hpp"
#include "rig_bridge/wear/forecast.hpp"
#include "rig_bridge/wear/population_io.hpp"
#include "rig_bridge/wear/wear_campaign.hpp"

namespace wear {

struct ForecastRequest {
    std::filesystem::path config = settings::config_directory();
    std::optional<double> limit;      ///< mean friction; none: the loss of the torque reserve, reserve_limit()
    std::string mix;                  ///< landings to come, see configured_mix(); empty: as the newest 100 of the campaign
    double slip = 0.24;               ///< slip at which those of `mix` are held
    std::optional<double> energy_MJ;  ///< energy of each landing to come, instead of `mix`
    std::size_t last = 0;             ///< number of the newest maneuvers to learn from; 0: all
    std::string method = "shipped";   ///< or "filter": only BrakeFilter
    int horizon = ForecastSettings{}.horizon;
    int draws = ForecastSettings{}.draws;
    std::uint64_t seed = 1;
};

/// The request with the values of the configuration.
struct ResolvedRequest {
    ForecastSettings settings;
    std::optional<ReserveLimit> reserve;
    std::vector<std::filesystem::path> files;  ///< files of the configuration that were used
};
[[nodiscard]] ResolvedRequest resolved(const ForecastRequest& request);

struct ForecastAnswer {
    Forecast forecast;
    LandingMix mix;
    settings::Json json;  ///< contents of forecast.json
};

/// Throws std::invalid_argument or settings::Error for an invalid request, as configured_mix() and forecast() do.
[[nodiscard]] ForecastAnswer answer(const ForecastRequest& request, ResolvedRequest resolved, const PopulationFile& by, const Campaign& campaign);

/// Head of every file that is made with a population.
[[nodiscard]] settings::Json json_head(const ResolvedRequest& resolved, const PopulationFile& by);

}  // namespace wear
