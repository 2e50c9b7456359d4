/// Computes a maneuver's figures and warnings from its bus log alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "firmware/can/layout.hpp"
#include "rig_bridge/record/bus_meter.hpp"
#include "rig_bridge/replay/line_source.hpp"
#include "rig_bridge/replay/log_warnings.hpp"

namespace rig::replay {

struct MeteredLog {
    /// The log has a brake-on, from which the figures are computed; or it ends with the wheel on the turning rim, so that braking may have followed.
    bool counts = false;
    record::Figures figures;
    /// Warnings of the meter; for a damaged log also "log_damaged: unfinished_line 1"; for one that ends with the wheel on the rim, before or during
    /// braking, "ends_in_braking: at 15.8 m/s, and the brake may have taken up to 0.481 MJ that are in no record": the remaining kinetic energy minus
    /// that still present in kFoundLog. If the rim was found coasting at once, the energy it lost is included in the energies.
    std::vector<std::string> warnings;
    antiskid::control::FaultSet faults;
    std::uint64_t frames = 0;
    std::uint64_t lines = 0;
};

/// File beside the log of a bridge that died: the bus as the next bridge found it.
inline constexpr const char* kFoundLog = "found.log";

/// bus.log or bus.log.gz in a maneuver's folder; empty if there is neither.
[[nodiscard]] std::filesystem::path log_in(const std::filesystem::path& folder);

/// closed: the bridge completed the record, with a summary.json. left: it died, and the maneuver may have continued after the log.
enum class LogEnd : std::uint8_t { closed, left };

/// Throws std::runtime_error if the log cannot be opened.
[[nodiscard]] MeteredLog meter_log(const std::filesystem::path& log, const antiskid::can::Layout& layout, const record::MeterParameters& parameters,
                                   LogEnd end, LogWarnings& warnings);
/// Of a closed log in memory.
[[nodiscard]] MeteredLog meter_log(LogText log, const antiskid::can::Layout& layout, const record::MeterParameters& parameters,
                                   LogWarnings& warnings);

}  // namespace rig::replay
