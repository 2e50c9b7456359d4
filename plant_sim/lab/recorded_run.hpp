/// Recordings of rig-bridge or rig-lab maneuver for the identification.
#pragma once

#include <filesystem>
#include <vector>

#include "firmware/can/layout.hpp"
#include "plant_sim/study/identification/recording.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace plant_sim::lab {

/// Reads a bus log, plain or gzip (rig_bridge/record/sample_stream.hpp). Throws std::runtime_error for a log that cannot be read or has no sample.
[[nodiscard]] identification::Recording read_recording(const std::filesystem::path& log, const antiskid::can::Layout& layout, double period_s);

/// Path in `config`/scenarios of the scenario named by summary.json in a run's folder.
[[nodiscard]] std::filesystem::path scenario_of(const std::filesystem::path& folder, const std::filesystem::path& config);

/// Combines a recording with the scenario's rig and surface. `map_currents` empty: those of the configured map.
[[nodiscard]] identification::Run run_of(const rig::Scenario& scenario, const std::filesystem::path& config, std::vector<double> map_currents,
                                         identification::Recording recording);

}  // namespace plant_sim::lab
