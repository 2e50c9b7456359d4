/// What a maneuver's bus log says by itself: its figures and what is wrong with them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "firmware/can/layout.hpp"
#include "rig_bridge/record/bus_meter.hpp"
#include "rig_bridge/replay/log_warnings.hpp"

namespace rig {

struct MeteredLog {
    bool braked = false;  ///< there is a brake-on in it: figures count from there
    Figures figures;
    /// Those of the meter; of a log that is not whole also "log_damaged: unfinished_line 1".
    std::vector<std::string> warnings;
    antiskid::control::FaultSet faults;
    std::uint64_t frames = 0;
    std::uint64_t lines = 0;
};

/// bus.log of a maneuver's folder, or bus.log.gz; empty when there is neither.
[[nodiscard]] std::filesystem::path log_in(const std::filesystem::path& folder);

/// Throws std::runtime_error when the log cannot be opened.
[[nodiscard]] MeteredLog meter_log(const std::filesystem::path& log, const antiskid::can::Layout& layout,
                                   const MeterParameters& parameters, LogWarnings& warnings);

}  // namespace rig
