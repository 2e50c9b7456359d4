#include "plant_sim/lab/panel_recordings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "firmware/control/types.hpp"
#include "firmware/host/controller_config.hpp"
#include "firmware/host/settings/json.hpp"
#include "plant_sim/study/identification/recording.hpp"
#include "rig_bridge/bridge/live_speed.hpp"
#include "rig_bridge/bridge/wall_clock.hpp"
#include "rig_bridge/panel/curves.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/specimen.hpp"
#include "rig_bridge/replay/log_meter.hpp"
#include "rig_bridge/replay/log_reader.hpp"
#include "rig_bridge/replay/log_warnings.hpp"
#include "rig_bridge/replay/measured_signals.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace plant_sim::lab {

namespace {

namespace record = rig::record;
namespace phase = identification::phase;
using rig::panel::Curves;
using rig::panel::LiveSample;
using rig::panel::Signal;
using settings::Json;

Json known(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json to_json(const record::LedgerRow& row, const std::string& campaign) {
    const record::Summary& s = row.summary;
    Json run{
        {"campaign", campaign},           {"number", row.attempt.number},
        {"attempt", row.attempt.attempt}, {"state", row.state == record::RowState::aborted ? "aborted: " + s.outcome : std::string(name(row.state))},
        {"started", s.started},           {"scenario", s.scenario}};
    Json& configuration = run["configuration"];
    configuration = {{"scenario", s.scenario},
                     {"slip reference", known(row.slip_reference)},
                     {"seed", s.seed},
                     {"version", s.version},
                     {"configuration hash", s.config_hash},
                     {"faults", fmt::format("{}", fmt::join(s.faults, " "))},
                     {"health", name(row.health.state)},
                     {"warnings", fmt::format("{}", fmt::join(s.warnings, "; "))}};
    for (const record::SpecimenField& field : record::kSpecimenFields) configuration[field.label] = s.specimen.*field.value;
    run["figures"] = Json::object();
    if (row.has_figures)
        for (const record::FigureField& field : record::kFigureFields) {
            const std::string unit = *field.unit == '\0' ? "" : ", " + std::string(field.unit);
            run["figures"][field.label + unit] = known(s.figures.*field.value * field.scale);
        }
    run["notes"] = Json::array();
    for (const record::Note& note : row.notes)
        run["notes"].push_back({{"field", note.field}, {"text", note.text}, {"who", note.who}, {"made", note.made}});
    return run;
}

/// The sample of this moment on the bus; speeds are those of `rim` and `wheel`.
LiveSample sample_of(const antiskid::can::BusView& view, const rig::Scenario& scenario, double rim_radps, double wheel_radps) {
    LiveSample sample;
    const bool loaded = view.load_cells_received != antiskid::control::kNever;
    const double load_N = loaded ? static_cast<double>(view.load_cells.vertical_N) : 0.0;
    sample[Signal::rim] = rim_radps * scenario.rig.rig.flywheel_radius_m;
    sample[Signal::wheel] = wheel_radps * scenario.rolling_radius_m(load_N);
    sample[Signal::slip] = static_cast<double>(view.controller.slip);
    sample[Signal::slip_reference] = static_cast<double>(view.controller.slip_reference);
    sample[Signal::demand] = static_cast<double>(view.maneuver.demand_Pa);
    sample[Signal::pressure] = static_cast<double>(view.pressure.pressure_Pa);
    sample[Signal::current] = static_cast<double>(view.controller.current_mA);
    if (loaded) sample[Signal::load] = load_N;
    return sample;
}

Curves read_curves(const std::filesystem::path& log, const antiskid::can::Layout& layout, const rig::Scenario& scenario) {
    rig::replay::LogWarnings warnings(log.string(), {});
    rig::replay::LogOptions options;
    options.layout = &layout;
    rig::replay::LogReader reader(log, options, warnings);
    const double period_s = static_cast<double>(antiskid::load_controller_config(scenario.controller).period_s);
    rig::replay::MeasuredSignals signals(reader, layout, period_s);
    rig::bridge::LiveSpeed rim(scenario.rig.rig.flywheel_encoder.teeth);
    rig::bridge::LiveSpeed wheel(scenario.rig.rig.wheel_encoder.teeth);
    std::vector<LiveSample> samples;
    double brake_on_s = std::numeric_limits<double>::quiet_NaN();
    while (signals.next()) {
        const antiskid::can::BusView& view = signals.view();
        const antiskid::control::Time now(std::llround(signals.time_s() * 1e9));
        rim.update(view.flywheel, now);
        wheel.update(view.wheel, now);
        const std::uint8_t at = view.maneuver_state.phase;
        if (at < phase::kTouchdown || at > phase::kRetract) continue;
        if (at == phase::kBraking && std::isnan(brake_on_s)) brake_on_s = signals.time_s();
        samples.push_back(sample_of(view, scenario, rim.radps(), wheel.radps()));
        samples.back().time_s = signals.time_s();
    }
    if (samples.empty()) throw std::runtime_error(log.string() + ": no sample with the wheel on the rim is in it");
    if (std::isnan(brake_on_s)) brake_on_s = samples.front().time_s;
    Curves curves;
    for (LiveSample& sample : samples) {
        sample.time_s -= brake_on_s;
        curves.add(sample);
    }
    return curves;
}

}  // namespace

PanelRecordings::PanelRecordings(std::filesystem::path folder, std::filesystem::path config, const antiskid::can::Layout& layout)
    : folder_(std::move(folder)), config_(std::move(config)), layout_(layout) {
    (void)record::read_campaigns(ledger());
}

std::string PanelRecordings::runs() const {
    Json all{{"runs", Json::array()}};
    for (const record::Campaign& campaign : record::read_campaigns(ledger()))
        for (const record::LedgerRow& row : record::read_ledger(ledger(), campaign.name)) all["runs"].push_back(to_json(row, campaign.name));
    return settings::json_line(all);
}

std::string PanelRecordings::run(const std::string& campaign, std::int64_t number, std::int64_t attempt) const {
    const std::vector<record::LedgerRow> rows = record::read_ledger(ledger(), campaign);
    const auto row = std::find_if(rows.begin(), rows.end(),
                                  [&](const record::LedgerRow& r) { return r.attempt.number == number && r.attempt.attempt == attempt; });
    if (row == rows.end()) throw std::runtime_error(fmt::format("campaign {} has no attempt {} at maneuver {}", campaign, attempt, number));
    const std::filesystem::path log = rig::replay::log_in(row->attempt.folder);
    if (log.empty()) throw std::runtime_error(row->attempt.folder.string() + ": has no bus.log: this maneuver was not recorded on a bus");
    const std::vector<record::Campaign> all = record::read_campaigns(ledger());
    const auto whose = std::find_if(all.begin(), all.end(), [&](const record::Campaign& c) { return c.name == campaign; });
    const rig::Scenario scenario = rig::load_scenario(config_ / "scenarios" / (whose->scenario + ".toml"), config_);
    return "{\"columns\":" + read_curves(log, layout_, scenario).json() + "}";
}

std::string PanelRecordings::note(const std::string& campaign, std::int64_t number, std::int64_t attempt, const std::string& who,
                                  const std::string& text) const {
    record::check_text("who", who);
    record::check_text("note", text);
    record::Ledger writing(ledger());
    writing.choose(campaign);
    writing.note(number, attempt, {.field = "notes", .text = text, .who = who, .made = rig::bridge::iso_8601(std::chrono::system_clock::now())});
    return R"({"said":"The note is in the ledger."})";
}

}  // namespace plant_sim::lab
