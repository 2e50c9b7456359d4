/// An endurance campaign in process, and its maneuvers again with friction from a model, until Ctrl-C.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace plant_sim::python {

struct EnduranceRequest {
    std::filesystem::path out, scenario, config;  ///< no scenario: that of `config`
    std::int64_t maneuvers = 500;
    std::uint64_t seed = 1;
};

/// As `rig-lab endurance`: leaves campaign.sqlite in `out`, goes on where that is there. The text of its table.json. Throws std::runtime_error for a
/// maneuver that was aborted. Python's lock is held by the caller, and free meanwhile.
[[nodiscard]] std::string endurance_table(const EnduranceRequest& request);

struct ReplayRequest {
    std::filesystem::path ledger, config;
    std::string campaign;
    std::string model;  ///< the text of a model.json
    std::uint64_t seed = 1;
};

/// As `rig-lab wear simulate --replay torque`, on the endurance rig: arrays of cumulative energy in J and of mean friction. Throws settings::Error.
[[nodiscard]] pybind11::tuple replayed_wear(const ReplayRequest& request);

}  // namespace plant_sim::python
