#include "rig_bridge/replay/log_meter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "rig_bridge/replay/log_reader.hpp"
#include "rig_bridge/rig/sequencer.hpp"

namespace rig::replay {

namespace fs = std::filesystem;

namespace {

/// After a power cut the last one or two seconds are missing in a log.
bool may_go_on_to_brake(rig::Phase phase) {
    using rig::Phase;
    return phase == Phase::touchdown || phase == Phase::settling || phase == Phase::braking;
}

/// State of the rig when the next bridge started.
struct FoundRig {
    double rim_mps = 0.0;
    double kinetic_J = 0.0;
    bool coasts = false;  ///< the brake has released, so lately that drag took less than 1 % of a stop
};

/// None: it is not known, or so late that the rig may have been moved.
std::optional<FoundRig> found_rig(const fs::path& file, Time left, const antiskid::can::Layout& layout, const record::MeterParameters& parameters) {
    constexpr Time kSoon{60'000'000'000}, kAtOnce{10'000'000'000};
    if (!fs::exists(file)) return std::nullopt;
    LogOptions options;
    options.layout = &layout;
    LogWarnings warnings(file.string(), {});
    LogReader reader(file, options, warnings);
    record::BusMeter meter(layout, parameters);
    LogFrame frame;
    while (reader.next(frame)) meter.accept(frame.frame);
    const Time later = frame.frame.received - left;
    if (meter.view().flywheel.received == antiskid::control::kNever || later < Time{} || later > kSoon) return std::nullopt;
    const double v = meter.meter().speed_mps();
    const bool released = static_cast<double>(meter.view().pressure.pressure_Pa) < record::kReleased_Pa;
    // Below drop-out a wheel may be held; a rig that restarted is at rest.
    return FoundRig{v, meter.meter().kinetic_energy_J(), released && later <= kAtOnce && v > parameters.drop_out_mps};
}

/// Adds the energy after the end of the log: the brake's part of the energy lost until the rig was found; the largest possible part of the rest is
/// reported.
void add_what_followed(MeteredLog& out, const record::Meter& meter, rig::Phase phase, const std::optional<FoundRig>& found) {
    constexpr double kBrakeShare = 0.88;  // 1 - slip; slip is between 0 and 0.24, that of the greatest friction
    double max_J = meter.kinetic_energy_J();
    std::string text = fmt::format("ends_in_{}: at {:.1f} m/s", name(phase), meter.speed_mps());
    if (found && found->rim_mps <= meter.speed_mps()) {
        max_J = std::max(max_J - found->kinetic_J, 0.0);
        text += fmt::format(", the rim still at {:.1f} m/s when the next bridge came", found->rim_mps);
        // In touchdown the spin-up of the wheel slows the rim.
        if (found->coasts && phase != rig::Phase::touchdown) {
            const double brake_J = kBrakeShare * max_J;
            out.figures.energy_brake_J += brake_J;
            out.figures.energy_tyre_J += max_J - brake_J;
            out.figures.kinetic_energy_J += max_J;
            max_J -= brake_J;
            text += fmt::format(", by which {:.3g} MJ count", brake_J * 1e-6);
        }
    }
    out.warnings.push_back(text + ", " + record::in_no_record(max_J));
}

/// `folder`: of kFoundLog, for a log that was left.
MeteredLog meter_all(LogReader& reader, const antiskid::can::Layout& layout, const record::MeterParameters& parameters, LogEnd end,
                     const fs::path& folder, const LogWarnings& warnings) {
    record::BusMeter meter(layout, parameters);
    LogFrame frame;
    while (reader.next(frame)) meter.accept(frame.frame);
    const auto phase = static_cast<rig::Phase>(meter.view().maneuver_state.phase);
    const bool cut_off = end == LogEnd::left && may_go_on_to_brake(phase);
    MeteredLog out{.counts = meter.meter().started() || meter.open() || cut_off,
                   .figures = meter.figures(),
                   .warnings = cut_off ? meter.meter().warnings() : meter.warnings(),
                   .faults = meter.faults(),
                   .frames = reader.frames(),
                   .lines = reader.lines()};
    if (cut_off) add_what_followed(out, meter.meter(), phase, found_rig(folder / kFoundLog, frame.frame.received, layout, parameters));
    for (std::string& damage : warnings.damage()) out.warnings.push_back(std::move(damage));
    return out;
}

}  // namespace

fs::path log_in(const fs::path& folder) {
    for (const char* name : {"bus.log", "bus.log.gz"})
        if (fs::exists(folder / name)) return folder / name;
    return {};
}

MeteredLog meter_log(const fs::path& log, const antiskid::can::Layout& layout, const record::MeterParameters& parameters, LogEnd end,
                     LogWarnings& warnings) {
    LogReader reader(log, {.interface = {}, .layout = &layout}, warnings);
    return meter_all(reader, layout, parameters, end, log.parent_path(), warnings);
}

MeteredLog meter_log(LogText log, const antiskid::can::Layout& layout, const record::MeterParameters& parameters, LogWarnings& warnings) {
    LogReader reader(log, {.interface = {}, .layout = &layout}, warnings);
    return meter_all(reader, layout, parameters, LogEnd::closed, {}, warnings);
}

}  // namespace rig::replay
