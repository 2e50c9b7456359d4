/// What a forecast of landings left is asked, and all that is said of its answer: of `rig-lab wear forecast` and the Python module.
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
    std::optional<double> limit;      ///< mean friction; none: where the torque reserve is gone, reserve_limit()
    std::string mix;                  ///< landings to come, as configured_mix() takes them; empty: as the newest 100 of the campaign
    double slip = 0.24;               ///< that those of `mix` are held at
    std::optional<double> energy_MJ;  ///< of each landing to come, instead of `mix`
    std::size_t last = 0;             ///< learn from so many of the newest maneuvers; 0: from all
    std::string method = "shipped";   ///< or "filter": BrakeFilter alone
    int horizon = ForecastSettings{}.horizon;
    int draws = ForecastSettings{}.draws;
    std::uint64_t seed = 1;
};

/// The request with what the configuration says.
struct ResolvedRequest {
    ForecastSettings settings;
    std::optional<ReserveLimit> reserve;
    std::vector<std::filesystem::path> files;  ///< of the configuration that went in
};
[[nodiscard]] ResolvedRequest resolved(const ForecastRequest& request);

struct ForecastAnswer {
    Forecast forecast;
    LandingMix mix;
    settings::Json json;  ///< of forecast.json
};

/// Throws std::invalid_argument or settings::Error for a request that cannot be, as configured_mix() and forecast() do.
[[nodiscard]] ForecastAnswer answer(const ForecastRequest& request, ResolvedRequest resolved, const PopulationFile& by, const Campaign& campaign);

/// What every file that comes of a population begins with.
[[nodiscard]] settings::Json json_head(const ResolvedRequest& resolved, const PopulationFile& by);

}  // namespace wear
