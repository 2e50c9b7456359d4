/// A bus log as NumPy arrays.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <optional>
#include <string>

namespace plant_sim::python {

struct LogFiles {
    std::filesystem::path log;
    std::string scenario;          ///< of config/scenarios: teeth and radii
    std::filesystem::path config;  ///< empty: as the programs have it
    std::filesystem::path dbc, binding;
    std::optional<std::string> interface;
};

/// The columns of `rig-replay export`, each an array. What is wrong with the log is a warning of Python's.
[[nodiscard]] pybind11::dict read_log(const LogFiles& files);

}  // namespace plant_sim::python
