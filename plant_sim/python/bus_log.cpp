#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/controller_config.hpp"
#include "firmware/host/layout_files.hpp"
#include "plant_sim/python/arrays.hpp"
#include "plant_sim/python/bindings.hpp"
#include "rig_bridge/replay/measured_signals.hpp"
#include "rig_bridge/replay/sample_table.hpp"
#include "rig_bridge/rig/meter_parameters.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace plant_sim::python {

namespace {

struct LogFiles {
    std::filesystem::path log;
    std::string scenario;          ///< name in config/scenarios, for teeth and radii
    std::filesystem::path config;  ///< empty: the programs' default
    std::filesystem::path dbc, binding;
    std::optional<std::string> interface;
};

struct Read {
    std::vector<std::string> names;
    std::vector<std::vector<double>> columns;
    std::vector<std::string> warnings;
};

Read read(const LogFiles& files) {
    const std::filesystem::path config = files.config.empty() ? settings::config_directory() : files.config;
    const auto layout = antiskid::LayoutFiles(config, files.dbc, files.binding).load();
    const rig::Scenario scenario = rig::load_scenario(config / "scenarios" / (files.scenario + ".toml"), config);
    const rig::record::MeterParameters parameters = rig::meter_parameters(scenario, antiskid::load_controller_config(scenario.controller));
    Read out;
    rig::replay::LogWarnings warnings(files.log.string(), [&](const std::string& text) { out.warnings.push_back(text); });
    rig::replay::LogOptions options;
    options.interface = files.interface;
    options.layout = &layout;
    rig::replay::LogReader reader(files.log, options, warnings);
    rig::replay::MeasuredSignals signals(reader, layout, parameters.period_s);
    rig::replay::SampleTable table(signals, layout, parameters);
    out.names = table.columns();
    out.columns.resize(out.names.size());
    for (std::vector<double> row; table.next(row);)
        for (std::size_t i = 0; i < row.size(); ++i) out.columns[i].push_back(row[i]);
    return out;
}

/// The columns of `rig-replay export`, each an array. Problems of the log become Python warnings.
py::dict read_log(const LogFiles& files) {
    const Read log = [&] {
        const py::gil_scoped_release others_run;
        return read(files);
    }();
    for (const std::string& warning : log.warnings) PyErr_WarnEx(PyExc_RuntimeWarning, warning.c_str(), 1);
    if (PyErr_Occurred() != nullptr) throw py::error_already_set();
    py::dict out;
    for (std::size_t i = 0; i < log.names.size(); ++i) out[log.names[i].c_str()] = column(log.columns[i]);
    return out;
}

}  // namespace

void bind_bus_log(py::module_& m) {
    m.def(
        "read_log",
        [](const std::filesystem::path& log, const std::string& scenario, const std::filesystem::path& config, const std::filesystem::path& dbc,
           const std::filesystem::path& binding, const std::optional<std::string>& interface) {
            return read_log({log, scenario, config, dbc, binding, interface});
        },
        py::arg("log"), py::kw_only(), py::arg("scenario") = "heavy", py::arg("config") = "", py::arg("dbc") = "", py::arg("binding") = "",
        py::arg("interface") = py::none());
}

}  // namespace plant_sim::python
