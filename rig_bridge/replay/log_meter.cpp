#include "rig_bridge/replay/log_meter.hpp"

#include <fmt/format.h>

#include <array>

#include "rig_bridge/replay/log_reader.hpp"
#include "rig_bridge/sequencer/sequencer.hpp"

namespace rig {

namespace fs = std::filesystem;

namespace {

/// A log says nothing of the last second or two before a power cut.
bool may_go_on_to_brake(sequencer::Phase phase) {
    using sequencer::Phase;
    return phase == Phase::touchdown || phase == Phase::settling || phase == Phase::braking;
}

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
    const auto phase = static_cast<sequencer::Phase>(meter.view().maneuver_state.phase);
    const bool cut_off = may_go_on_to_brake(phase);
    MeteredLog out{.counts = meter.meter().started() || cut_off,
                   .figures = meter.figures(),
                   .warnings = meter.warnings(),
                   .faults = meter.faults(),
                   .frames = reader.frames(),
                   .lines = reader.lines()};
    if (cut_off)
        out.warnings.push_back(fmt::format(
            "ends_in_{}: at {:.1f} m/s, and the brake may have taken up to {:.3g} MJ that are in no record",
            name(phase), meter.meter().speed_mps(), meter.meter().kinetic_energy_J() * 1e-6));
    constexpr std::array kDamage{LogTrouble::unfinished_line, LogTrouble::malformed_line,
                                 LogTrouble::not_text, LogTrouble::damaged_file};
    for (const LogTrouble trouble : kDamage)
        if (const std::uint64_t n = warnings.count(trouble); n != 0)
            out.warnings.push_back(fmt::format("log_damaged: {} {}", name(trouble), n));
    return out;
}

}  // namespace rig
