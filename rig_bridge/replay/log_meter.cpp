#include "rig_bridge/replay/log_meter.hpp"

#include <fmt/format.h>

#include <array>
#include <optional>

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

/// Of the rim, when the next bridge came; none where that is not known, or so late that anybody may have turned it.
std::optional<double> found_mps(const fs::path& file, Time left, const antiskid::can::Layout& layout,
                                const MeterParameters& parameters) {
    constexpr Time kSoon{60'000'000'000};
    if (!fs::exists(file)) return std::nullopt;
    LogOptions options;
    options.layout = &layout;
    LogWarnings warnings(file.string(), {});
    LogReader reader(file, options, warnings);
    BusMeter meter(layout, parameters);
    LogFrame frame;
    while (reader.next(frame)) meter.accept(frame.frame);
    const Time later = frame.frame.received - left;
    if (meter.view().flywheel.received == antiskid::control::kNever || later < Time{} || later > kSoon)
        return std::nullopt;
    return meter.meter().speed_mps();
}

std::string may_be_missing(const Meter& meter, sequencer::Phase phase, std::optional<double> found) {
    const double v = meter.speed_mps();
    double most_J = meter.kinetic_energy_J();
    std::string text = fmt::format("ends_in_{}: at {:.1f} m/s", name(phase), v);
    if (found && *found <= v) {
        most_J -= meter.kinetic_energy_J(*found);
        text += fmt::format(", the rim still at {:.1f} m/s when the next bridge came", *found);
    }
    return text +
           fmt::format(", and the brake may have taken up to {:.3g} MJ that are in no record", most_J * 1e-6);
}

}  // namespace

fs::path log_in(const fs::path& folder) {
    for (const char* name : {"bus.log", "bus.log.gz"})
        if (fs::exists(folder / name)) return folder / name;
    return {};
}

MeteredLog meter_log(const fs::path& log, const antiskid::can::Layout& layout,
                     const MeterParameters& parameters, LogEnd end, LogWarnings& warnings) {
    LogOptions options;
    options.layout = &layout;
    LogReader reader(log, options, warnings);
    BusMeter meter(layout, parameters);
    LogFrame frame;
    while (reader.next(frame)) meter.accept(frame.frame);
    const auto phase = static_cast<sequencer::Phase>(meter.view().maneuver_state.phase);
    const bool cut_off = end == LogEnd::left && may_go_on_to_brake(phase);
    MeteredLog out{.counts = meter.meter().started() || cut_off,
                   .figures = meter.figures(),
                   .warnings = meter.warnings(),
                   .faults = meter.faults(),
                   .frames = reader.frames(),
                   .lines = reader.lines()};
    if (cut_off)
        out.warnings.push_back(may_be_missing(
            meter.meter(), phase,
            found_mps(log.parent_path() / kFoundLog, frame.frame.received, layout, parameters)));
    constexpr std::array kDamage{LogTrouble::unfinished_line, LogTrouble::malformed_line,
                                 LogTrouble::not_text, LogTrouble::damaged_file};
    for (const LogTrouble trouble : kDamage)
        if (const std::uint64_t n = warnings.count(trouble); n != 0)
            out.warnings.push_back(fmt::format("log_damaged: {} {}", name(trouble), n));
    return out;
}

}  // namespace rig
