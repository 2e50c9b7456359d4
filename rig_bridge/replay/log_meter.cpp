#include "rig_bridge/replay/log_meter.hpp"

#include <fmt/format.h>

#include <array>

#include "rig_bridge/replay/log_reader.hpp"
#include "rig_bridge/sequencer/sequencer.hpp"

namespace rig {

namespace fs = std::filesystem;

namespace {

constexpr auto kBraking = static_cast<std::uint8_t>(sequencer::Phase::braking);

}  // namespace

fs::path log_in(const fs::path& folder) {
    for (const char* name : {"bus.log", "bus.log.gz"})
        if (fs::exists(folder / name)) return folder / name;
    return {};
}

MeteredLog meter_log(const fs::path& log, const antiskid::can::Layout& layout,
                     const MeterParameters& parameters, LogWarnings& warnings) {
    LogOptions options;
    options.layout = &layout;
    LogReader reader(log, options, warnings);
    BusMeter meter(layout, parameters);
    for (LogFrame frame; reader.next(frame);) meter.accept(frame.frame);
    MeteredLog out{.braked = meter.meter().started(),
                   .figures = meter.figures(),
                   .warnings = meter.warnings(),
                   .faults = meter.faults(),
                   .frames = reader.frames(),
                   .lines = reader.lines()};
    if (out.braked && meter.view().maneuver_state.phase == kBraking)
        out.warnings.push_back(
            fmt::format("ends_in_braking: at {:.1f} m/s, what was braked after that is not known",
                        meter.meter().speed_mps()));
    constexpr std::array kDamage{LogTrouble::unfinished_line, LogTrouble::malformed_line,
                                 LogTrouble::not_text, LogTrouble::damaged_file};
    for (const LogTrouble trouble : kDamage)
        if (const std::uint64_t n = warnings.count(trouble); n != 0)
            out.warnings.push_back(fmt::format("log_damaged: {} {}", name(trouble), n));
    return out;
}

}  // namespace rig
