/// A bus log as NumPy arrays.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <optional>
#include <string>

namespace plant_sim::python {

struct LogFiles {
    std::filesystem::path log;
    std::string scenario;          ///< name in config/scenarios, for teeth and radii
    std::filesystem::path config;  ///< empty: the programs' default
    std::filesystem::path dbc, binding;
    std::optional<std::string> interface;
};

/// The columns of `rig-replay export`, each an array. Problems of the log become Python warnings.
[[nodiscard]] pybind11::dict read_log(const LogFiles& files);

}  // namespace plant_sim::python
