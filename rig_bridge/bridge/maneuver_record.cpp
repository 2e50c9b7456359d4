#include "rig_bridge/bridge/maneuver_record.hpp"

#include "firmware/can/names.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/replay/log_meter.hpp"
#include "rig_bridge/rig/acceptance.hpp"

namespace rig::bridge {

namespace {

record::Summary made_with(const BridgeSetup& setup) {
    record::Summary summary;
    summary.scenario = setup.scenario.name;
    summary.seed = setup.options.seed;
    summary.version = ANTISKID_VERSION;
    summary.config_hash = setup.config_hash;
    return summary;
}

}  // namespace

record::Summary summary_of(const BridgeSetup& setup, const ManeuverRequest& request, const rig::Sequencer& sequencer, const std::string& started,
                           const Recording& recording, bool whole) {
    const bool finished = sequencer.phase() == rig::Phase::finished;
    record::Summary s = made_with(setup);
    s.campaign = request.campaign;
    s.number = request.number;
    s.specimen = request.specimen;
    s.outcome = !whole ? record::kRecordLost : finished ? name(rig::Phase::finished) : name(sequencer.abort());
    s.started = started;
    s.figures = recording.meter.figures();
    s.warnings = recording.meter.warnings();
    if (finished)
        if (const std::vector<Band> bands = acceptance(setup.scenario, request.plan); !bands.empty())
            s.out_of_tolerance = out_of_tolerance(bands, s.figures);
    s.cumulative_energy_J = request.taken_J + record::counted_energy_J(s);
    s.faults = antiskid::can::fault_names(recording.meter.faults());
    s.frames = recording.log.frames() - recording.log.missing();
    s.frames_dropped = recording.dropped;
    return s;
}

std::optional<record::Summary> summary_of_left(const BridgeSetup& setup, const record::Attempt& left, const std::filesystem::path& log) {
    replay::LogWarnings warnings(log.string(), {});
    const replay::MeteredLog metered = replay::meter_log(log, setup.layout, setup.meter, replay::LogEnd::left, warnings);
    if (!metered.counts) return std::nullopt;
    record::Summary summary = made_with(setup);
    summary.number = left.number;
    summary.outcome = name(record::RowState::unfinished);
    summary.figures = metered.figures;
    summary.warnings = metered.warnings;
    summary.faults = antiskid::can::fault_names(metered.faults);
    summary.frames = metered.frames;
    return summary;
}

void enter(record::Ledger& ledger, const std::filesystem::path& folder, const record::Summary& summary, const settings::Storage& storage) {
    if (summary.outcome == record::kRecordLost) {
        ledger.mark_unfinished(summary);
        return;
    }
    record::write_summary(folder / "summary.json", summary, storage);
    ledger.finish(summary);
}

}  // namespace rig::bridge
