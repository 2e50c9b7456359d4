#include "rig_bridge/bridge/panel_recordings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "firmware/can/value_names.hpp"
#include "firmware/control/types.hpp"
#include "firmware/host/controller_config.hpp"
#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/json.hpp"
#include "rig_bridge/bridge/live_speed.hpp"
#include "rig_bridge/bridge/wall_clock.hpp"
#include "rig_bridge/panel/curves.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/specimen.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/replay/log_meter.hpp"
#include "rig_bridge/replay/log_reader.hpp"
#include "rig_bridge/replay/log_warnings.hpp"
#include "rig_bridge/replay/measured_signals.hpp"
#include "rig_bridge/rig/sequencer.hpp"

namespace rig::bridge {

namespace {

using panel::Curves;
using panel::LiveSample;
using panel::Signal;
using settings::Json;

Json to_json(const record::LedgerRow& row, const std::string& campaign) {
    const record::Summary& s = row.summary;
    Json run{
        {"campaign", campaign},           {"number", row.attempt.number},
        {"attempt", row.attempt.attempt}, {"state", row.state == record::RowState::aborted ? "aborted: " + s.outcome : std::string(name(row.state))},
        {"started", s.started},           {"scenario", s.scenario}};
    Json& configuration = run["configuration"];
    configuration = {{"scenario", s.scenario},
                     {"slip reference", row.slip_reference},
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
            run["figures"][field.label + unit] = s.figures.*field.value * field.scale;
        }
    run["notes"] = Json::array();
    for (const record::Note& note : row.notes)
        run["notes"].push_back({{"field", note.field}, {"text", note.text}, {"who", note.who}, {"made", note.made}});
    return run;
}

/// The sample of this moment on the bus; speeds are those of `rim` and `wheel`.
LiveSample sample_of(const antiskid::can::BusView& view, const Scenario& scenario, double rim_radps, double wheel_radps) {
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

/// What the controller was told where the demand was greatest; a demand of nothing is none.
struct GreatestDemand {
    void take(const antiskid::control::ManeuverInput& command) {
        if (command.demand_Pa > demand_Pa) *this = {command.law, command.demand_Pa, command.slip_reference};
    }
    [[nodiscard]] Json json() const {
        const bool known = demand_Pa > 0.0F;
        const auto code = static_cast<std::size_t>(law);
        const bool named = known && code < antiskid::can::kLawNames.size();
        return {{"law on the bus", named ? antiskid::can::kLawNames[code] : std::string_view("unknown")},
                {"greatest demand on the bus, MPa", known ? Json(1e-6 * static_cast<double>(demand_Pa)) : Json("unknown")},
                {"slip reference on the bus", known ? Json(static_cast<double>(slip_reference)) : Json("unknown")}};
    }

    antiskid::control::Law law{};
    float demand_Pa = 0.0F;
    float slip_reference = 0.0F;
};

struct Drawn {
    Curves curves;
    GreatestDemand greatest;
};

Drawn read_log(const std::filesystem::path& log, const antiskid::can::Layout& layout, const Scenario& scenario) {
    replay::LogWarnings warnings(log.string(), {});
    replay::LogOptions options;
    options.layout = &layout;
    replay::LogReader reader(log, options, warnings);
    const double period_s = static_cast<double>(antiskid::load_controller_config(scenario.controller).period_s);
    replay::MeasuredSignals signals(reader, layout, period_s);
    LiveSpeed rim(scenario.rig.rig.flywheel_encoder.teeth);
    LiveSpeed wheel(scenario.rig.rig.wheel_encoder.teeth);
    std::vector<LiveSample> samples;
    Drawn drawn;
    double brake_on_s = std::numeric_limits<double>::quiet_NaN();
    while (signals.next()) {
        const antiskid::can::BusView& view = signals.view();
        rim.update(view.flywheel);
        wheel.update(view.wheel);
        const auto at = static_cast<Phase>(view.maneuver_state.phase);
        if (at < Phase::touchdown || at > Phase::retract) continue;
        if (at == Phase::braking) {
            if (std::isnan(brake_on_s)) brake_on_s = signals.time_s();
            drawn.greatest.take(view.maneuver);
        }
        samples.push_back(sample_of(view, scenario, rim.radps(), wheel.radps()));
        samples.back().time_s = signals.time_s();
    }
    if (samples.empty()) throw std::runtime_error(log.string() + ": no sample with the wheel on the rim is in it");
    if (std::isnan(brake_on_s)) brake_on_s = samples.front().time_s;
    for (LiveSample& sample : samples) {
        sample.time_s -= brake_on_s;
        drawn.curves.add(sample);
    }
    return drawn;
}

}  // namespace

PanelRecordings::PanelRecordings(const std::filesystem::path& folder, std::filesystem::path config, const antiskid::can::Layout& layout,
                                 std::optional<Scenario> known)
    : folder_(std::filesystem::weakly_canonical(folder)), config_(std::move(config)), layout_(layout), known_(std::move(known)) {
    if (all().empty() && !with_ledger())
        throw settings::Error(folder_.string(), 0, "", "no campaign.sqlite here, and no folder with the summary.json of a maneuver");
}

bool PanelRecordings::with_ledger() const {
    return std::filesystem::exists(ledger());
}

std::vector<PanelRecordings::Recorded> PanelRecordings::all() const {
    if (!with_ledger()) return in_folders();
    std::vector<Recorded> all;
    for (const record::Campaign& campaign : record::read_campaigns(ledger()))
        for (record::LedgerRow& row : record::read_ledger(ledger(), campaign.name)) all.push_back({campaign.name, std::move(row), {}});
    return all;
}

std::vector<PanelRecordings::Recorded> PanelRecordings::in_folders() const {
    namespace fs = std::filesystem;
    constexpr const char* kSummary = "summary.json";
    std::vector<fs::path> folders;
    if (fs::exists(folder_ / kSummary)) folders.push_back(folder_);
    for (fs::recursive_directory_iterator at(folder_, fs::directory_options::skip_permission_denied), end; at != end; ++at) {
        if (at.depth() == 1) at.disable_recursion_pending();
        if (at->is_directory() && fs::exists(at->path() / kSummary)) folders.push_back(at->path());
    }
    std::sort(folders.begin(), folders.end());
    std::vector<Recorded> all;
    for (const fs::path& folder : folders) {
        record::LedgerRow row;
        // Maneuvers of different campaigns may have the same number; the page tells them apart by this one.
        row.attempt = {.number = static_cast<std::int64_t>(all.size() + 1), .attempt = 1, .folder = folder};
        std::string unreadable;
        try {
            row.summary = record::read_summary(folder / kSummary);
            row.state = row.summary.outcome == name(record::RowState::finished) ? record::RowState::finished : record::RowState::aborted;
            row.has_figures = true;
        } catch (const std::exception& error) {
            unreadable = error.what();
        }
        const fs::path campaign = folder == folder_ ? folder.filename() : folder.lexically_relative(folder_);
        all.push_back({campaign.string(), std::move(row), std::move(unreadable)});
    }
    return all;
}

std::string PanelRecordings::runs() const {
    Json runs{{"runs", Json::array()}};
    for (const Recorded& recorded : all()) {
        Json run = to_json(recorded.row, recorded.campaign);
        if (!recorded.unreadable.empty()) {
            run["state"] = "summary.json cannot be read";
            run["configuration"]["notes"] = recorded.unreadable;
        }
        runs["runs"].push_back(std::move(run));
    }
    return settings::json_line(runs);
}

std::string PanelRecordings::run(const std::string& campaign, std::int64_t number, std::int64_t attempt) const {
    for (const auto& [of, row, unreadable] : all()) {
        if (of != campaign || row.attempt.number != number || row.attempt.attempt != attempt) continue;
        if (!unreadable.empty()) throw std::runtime_error(unreadable);
        const std::filesystem::path log = replay::log_in(row.attempt.folder);
        if (log.empty()) throw std::runtime_error(row.attempt.folder.string() + ": has no bus.log: this maneuver was not recorded on a bus");
        const std::lock_guard one(reading_);
        const Drawn drawn = read_log(log, layout_,
                                     known_ && known_->name == row.summary.scenario
                                         ? *known_
                                         : load_scenario(config_ / "scenarios" / (row.summary.scenario + ".toml"), config_));
        return "{\"columns\":" + drawn.curves.json() + ",\"asked\":" + settings::json_line(drawn.greatest.json()) + "}";
    }
    throw std::runtime_error(fmt::format("campaign {} has no attempt {} at maneuver {}", campaign, attempt, number));
}

std::string PanelRecordings::note(const std::string& campaign, std::int64_t number, std::int64_t attempt, const std::string& who,
                                  const std::string& text) const {
    record::check_text("who", who);
    record::check_text("note", text);
    if (!with_ledger()) throw record::LedgerError(folder_.string() + ": has no campaign.sqlite to keep a note in");  // opened, it would be made
    record::Ledger writing(ledger());
    writing.choose(campaign);
    writing.note(number, attempt, {.field = "notes", .text = text, .who = who, .made = iso_8601(std::chrono::system_clock::now())});
    return R"({"said":"The note is in the ledger."})";
}

void add_recorded(panel::ServerOptions& options, const PanelRecordings& recordings) {
    options.about.views.emplace_back("recorded");
    options.reads["runs"] = [&recordings](const panel::Query&) { return recordings.runs(); };
    options.reads["run"] = [&recordings](const panel::Query& q) {
        return recordings.run(q.text("campaign"), q.integer("number"), q.integer("attempt"));
    };
}

}  // namespace rig::bridge
