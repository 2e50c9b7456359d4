/// Wear learnt and forecast from arrays, as the verbs of `rig-lab wear` do it.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "plant_sim/wear/forecast_request.hpp"
#include "rig_bridge/wear/fit.hpp"

namespace plant_sim::python {

/// A brake's maneuvers, in their order.
struct WearPoints {
    std::vector<double> energy_J;  ///< c_e
    std::vector<double> friction;
    std::string source;  ///< for people
    std::string origin;  ///< provenance.hpp; empty: unknown
};

/// model.json of `rig-lab wear fit`. `threads`: 0 for all cores.
[[nodiscard]] pybind11::object fit_wear(const WearPoints& points, const wear::FitSettings& settings, unsigned threads);

/// forecast.json of `rig-lab wear forecast`, and `provenance`, a sentence.
[[nodiscard]] pybind11::object landings_left(const WearPoints& points, const std::filesystem::path& population, const wear::ForecastRequest& request);

}  // namespace plant_sim::python
