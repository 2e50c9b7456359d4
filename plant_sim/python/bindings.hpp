/// The parts of antiskid._native, which antiskid/__init__.pyi describes, a file each. Long work lets Python's other threads run.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <optional>
#include <vector>

#include "firmware/host/settings/config_directory.hpp"

namespace plant_sim::python {

namespace py = pybind11;

/// Each adds its classes and functions to the module.
void bind_bus_log(py::module_& m);
void bind_endurance(py::module_& m);
void bind_ledger(py::module_& m);
void bind_studies(py::module_& m);
void bind_wear(py::module_& m);

using Numbers = std::vector<double>;
using Directory = std::optional<std::filesystem::path>;

/// `config`, or the programs' default.
[[nodiscard]] inline std::filesystem::path directory_of(const Directory& config) {
    return config ? *config : settings::config_directory();
}

}  // namespace plant_sim::python
