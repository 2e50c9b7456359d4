/// What rig-bridge (or rig-lab maneuver) recorded, as the identification reads it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/can/layout.hpp"
#include "plant_sim/study/identification/recording.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace plant_sim::lab {

/// A bus log, plain or gzip, sample by sample (rig_bridge/record/sample_stream.hpp). Throws std::runtime_error for a log that cannot be read
/// or holds no sample.
[[nodiscard]] identification::Recording read_recording(const std::filesystem::path& log, const antiskid::can::Layout& layout, double period_s);

/// The scenario that a run's folder names in summary.json, out of `config`/scenarios.
[[nodiscard]] std::filesystem::path scenario_of(const std::filesystem::path& folder, const std::filesystem::path& config);

/// What a scenario says of rig and road. `map_currents` empty: those of the configured map.
[[nodiscard]] identification::Run run_of(const rig::Scenario& scenario, const std::filesystem::path& config, std::vector<double> map_currents,
                                         identification::Recording recording);

}  // namespace plant_sim::lab
