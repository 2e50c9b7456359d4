/// Learns and forecasts wear from arrays, as the verbs of `rig-lab wear`.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <string>
#include <vector>

#include "plant_sim/wear/forecast_request.hpp"
#include "rig_bridge/wear/fit.hpp"
#include "rig_bridge/wear/wear_campaign.hpp"

namespace plant_sim::python {

/// Maneuvers of a brake, in their order.
struct WearPoints {
    std::vector<double> energy_J;  ///< c_e
    std::vector<double> friction;
    std::string source;                         ///< for people
    std::string origin{};                       ///< see provenance.hpp; empty: unknown
    std::vector<wear::LiningReading> lining{};  ///< in their order
};

/// Throws std::invalid_argument if one list is longer.
[[nodiscard]] std::vector<wear::LiningReading> readings_of(const std::vector<double>& energy_J, const std::vector<double>& worn);

/// Contents of the model.json of `rig-lab wear fit`. `threads`: 0: all cores.
[[nodiscard]] pybind11::object fit_wear(const WearPoints& points, const wear::FitSettings& settings, unsigned threads);

/// Contents of the forecast.json of `rig-lab wear forecast`, and `provenance`, a sentence.
[[nodiscard]] pybind11::object landings_left(const WearPoints& points, const std::filesystem::path& population, const wear::ForecastRequest& request);

}  // namespace plant_sim::python
