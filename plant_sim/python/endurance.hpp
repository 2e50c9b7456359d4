/// An endurance campaign in process, and the repetition of its maneuvers with a model's friction. Ctrl-C ends both.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace plant_sim::python {

struct EnduranceRequest {
    std::filesystem::path out, scenario, config;  ///< scenario empty: that of `config`
    std::int64_t maneuvers = 500;
    std::uint64_t seed = 1;
};

/// As `rig-lab endurance`: writes campaign.sqlite in `out`, or continues it. Returns the text of its table.json. Throws std::runtime_error for an
/// aborted maneuver. The caller must hold Python's lock, which is released during the run.
[[nodiscard]] std::string endurance_table(const EnduranceRequest& request);

struct ReplayRequest {
    std::filesystem::path ledger, config;
    std::string campaign;
    std::string model;  ///< text of a model.json
    std::uint64_t seed = 1;
};

/// As `rig-lab wear simulate --replay torque` on the endurance rig: arrays of cumulative energy in J and of mean friction. Throws settings::Error.
[[nodiscard]] pybind11::tuple replayed_wear(const ReplayRequest& request);

}  // namespace plant_sim::python
