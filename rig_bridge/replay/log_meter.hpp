/// What a maneuver's bus log says by itself: its figures and what is wrong with them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "firmware/can/layout.hpp"
#include "rig_bridge/record/bus_meter.hpp"
#include "rig_bridge/replay/log_warnings.hpp"

namespace rig::replay {

struct MeteredLog {
    /// There is a brake-on in it, from which figures count; or it was left with the wheel on the turning rim, and the brake may have come on then.
    bool counts = false;
    record::Figures figures;
    /// Those of the meter; of a log that is not whole also "log_damaged: unfinished_line 1"; of one that was left with the wheel on the rim, before
    /// or in braking, "ends_in_braking: at 15.8 m/s, and the brake may have taken up to 0.481 MJ that are in no record": all that was left, less what
    /// kFoundLog says that the rim still had. Of one that was found coasting at once, what the rim lost is in the energies.
    std::vector<std::string> warnings;
    antiskid::control::FaultSet faults;
    std::uint64_t frames = 0;
    std::uint64_t lines = 0;
};

/// Beside a log that a dead bridge left: the bus as the next one found it.
inline constexpr const char* kFoundLog = "found.log";

/// bus.log of a maneuver's folder, or bus.log.gz; empty when there is neither.
[[nodiscard]] std::filesystem::path log_in(const std::filesystem::path& folder);

/// Whether the bridge that wrote it came to its end: then there is a summary.json, and nothing happened after the log.
enum class LogEnd : std::uint8_t { closed, left };

/// Throws std::runtime_error when the log cannot be opened.
[[nodiscard]] MeteredLog meter_log(const std::filesystem::path& log, const antiskid::can::Layout& layout, const record::MeterParameters& parameters,
                                   LogEnd end, LogWarnings& warnings);

}  // namespace rig::replay
