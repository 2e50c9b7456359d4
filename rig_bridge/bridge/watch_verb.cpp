#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <optional>
#include <thread>

#include "firmware/can/names.hpp"
#include "firmware/can/roles.hpp"
#include "firmware/can/value_names.hpp"
#include "firmware/host/controller_config.hpp"
#include "firmware/host/layout_files.hpp"
#include "firmware/host/seconds.hpp"
#include "firmware/host/settings/command_line.hpp"
#include "firmware/host/stop_signals.hpp"
#include "rig_bridge/bridge/bus_recorder.hpp"
#include "rig_bridge/bridge/campaign_rules.hpp"
#include "rig_bridge/bridge/hold.hpp"
#include "rig_bridge/bridge/rig_time.hpp"
#include "rig_bridge/bridge/terminal.hpp"
#include "rig_bridge/bridge/verbs.hpp"
#include "rig_bridge/bridge/view_model.hpp"
#include "rig_bridge/bridge/watch_view.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/rig/meter_parameters.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace rig::bridge {

namespace {

using antiskid::can::Role;
using antiskid::control::kNever;
using antiskid::control::Time;
using antiskid::host::seconds;
using rig::Phase;

/// The campaign that was last started or resumed.
record::Campaign newest_campaign(const std::filesystem::path& file) {
    const std::vector<record::Campaign> all = record::read_campaigns(file);
    if (all.empty()) throw UsageError(file.string() + ": has no campaign yet");
    record::Campaign newest = all.back();
    std::string begun;
    for (const record::Campaign& campaign : all) {
        const std::vector<record::LedgerRow> rows = record::read_ledger(file, campaign.name);
        if (rows.empty() || rows.back().summary.started < begun) continue;
        begun = rows.back().summary.started;
        newest = campaign;
    }
    return newest;
}

/// Seconds since 1970 of a stamp as iso_8601() writes it; NaN: none.
double seconds_of(const std::string& stamp) {
    std::tm parts{};
    if (strptime(stamp.c_str(), "%Y-%m-%dT%H:%M:%SZ", &parts) == nullptr) return std::nan("");
    return static_cast<double>(timegm(&parts));
}

/// From begin to begin of the newest attempts, holds and restarts included.
std::optional<double> left_s(const std::vector<record::LedgerRow>& rows, std::int64_t maneuvers) {
    Pace pace;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        const double took_s = seconds_of(rows[i].summary.started) - seconds_of(rows[i - 1].summary.started);
        if (took_s >= 0.0 && rows[i - 1].state == record::RowState::finished) pace.add(took_s);
    }
    return pace.left_s(maneuvers);
}

void read_campaign_into(WatchedCampaign& w, const std::filesystem::path& directory) {
    constexpr std::size_t kOutcomes = 4;
    const std::filesystem::path file = ledger_file(directory);
    const record::Campaign campaign = newest_campaign(file);
    const std::vector<record::LedgerRow> rows = record::read_ledger(file, campaign.name);
    w.campaign = campaign.name;
    w.planned = campaign.planned;
    w.finished = std::count_if(rows.begin(), rows.end(), [](const record::LedgerRow& row) { return row.state == record::RowState::finished; });
    w.left_s = left_s(rows, w.planned - w.finished);
    w.specimen = to_text(rows.empty() ? campaign.specimen : rows.back().summary.specimen);
    w.bridge.with_ledger = true;
    w.bridge.held = record::is_held(file);
    w.bridge.running = 0;
    w.outcomes.clear();
    for (const record::LedgerRow& row : rows) {
        if (row.state == record::RowState::running) {
            w.bridge.running = row.attempt.number;
            continue;
        }
        w.outcomes.push_back(row.attempt.folder.filename().string() + " " + (row.summary.outcome.empty() ? name(row.state) : row.summary.outcome) +
                             (record::off_conditions(row.summary) ? " (out_of_tolerance)" : ""));
    }
    if (w.outcomes.size() > kOutcomes) w.outcomes.erase(w.outcomes.begin(), w.outcomes.end() - kOutcomes);
    const auto hold = read_hold(directory);
    w.hold = hold ? to_text(*hold) : "";
}

/// Listens to the bus and reads the ledger; sends and writes nothing.
class Watch {
  public:
    Watch(const WatchCommand& command, const antiskid::can::Layout& layout, const record::MeterParameters& meter)
        : command_(command), layout_(layout), bus_(command.interface, layout, meter, [] {}), rig_time_(meter.period_s) {}

    void look(Time now) {
        const BusNow bus = bus_.now();
        hear(bus, now);
        if (!command_.directory.empty() && now >= next_ledger_) {
            next_ledger_ = now + std::chrono::seconds(1);
            try {
                read_campaign_into(seen_, command_.directory);
                seen_.ledger_error.clear();
            } catch (const record::LedgerError& error) {
                seen_.ledger_error = error.what();
            }
        }
    }
    [[nodiscard]] const WatchedCampaign& seen() const { return seen_; }
    [[nodiscard]] const StripChart& chart() const { return chart_; }
    void scenario(const std::string& title) { seen_.scenario = title; }

  private:
    void hear(const BusNow& bus, Time now) {
        constexpr double kSilent_s = 0.5;
        const auto fresh = [&](Time received) { return received != kNever && seconds(now - received) <= kSilent_s; };
        const antiskid::can::BusView& v = bus.view;
        seen_.bus_up = bus.up;
        seen_.bus_error = bus.error;
        const Time bridge = std::max(v.maneuver_state_received, v.rig_heartbeat_received);
        if (bridge != kNever) seen_.bridge.silent_s = std::max(0.0, seconds(now - bridge));
        const double rig_s = rig_time_.at(seconds(now), bus.syncs);
        if (v.maneuver_state_received != kNever) {
            const auto phase = static_cast<Phase>(v.maneuver_state.phase);
            seen_.number = v.maneuver_state.number;
            if (seen_.phase != phase) {
                seen_.phase_began = seen_.phase.has_value();
                phase_began_s_ = rig_s;
                seen_.phase = phase;
            }
            seen_.phase_s = rig_s - phase_began_s_;
        }
        seen_.rim_mps = fresh(v.flywheel.received) ? bus.rim_mps : std::nan("");
        seen_.wheel_mps = fresh(v.wheel.received) ? bus.wheel_rim_mps : std::nan("");
        const bool lands = seen_.phase && *seen_.phase >= Phase::settling && *seen_.phase <= Phase::standstill;
        seen_.slip = lands ? bus.slip : 0.0;
        seen_.pressure_Pa = fresh(v.pressure.received) ? static_cast<double>(v.pressure.pressure_Pa) : std::nan("");
        seen_.load_N = fresh(v.load_cells_received) ? static_cast<double>(v.load_cells.vertical_N) : std::nan("");
        hear_controller(bus, fresh);
        chart_.add({.time_s = rig_s,
                    .rim_mps = seen_.rim_mps,
                    .wheel_mps = seen_.wheel_mps,
                    .slip = seen_.slip,
                    .slip_reference = seen_.slip_reference,
                    .pressure_Pa = seen_.pressure_Pa});
    }

    template <typename Fresh>
    void hear_controller(const BusNow& bus, const Fresh& fresh) {
        const antiskid::can::ControllerView& c = bus.view.controller;
        const bool speaks = fresh(c.status_received);
        seen_.controller = speaks                            ? antiskid::can::kStateNames[static_cast<std::size_t>(c.state)]
                           : bus.controller_rejected.empty() ? std::string_view("silent")
                                                             : std::string_view("rejected");
        seen_.senders = senders_text(bus, speaks);
        seen_.slip_reference = speaks ? static_cast<double>(c.slip_reference) : 0.0;
        seen_.current_mA = fresh(c.command_received) ? static_cast<double>(c.current_mA) : std::nan("");
        seen_.faults = speaks ? antiskid::can::fault_names(c.faults) : std::vector<std::string>{};
        seen_.tells_road = layout_[Role::road].bound;
        seen_.road = fresh(c.road_received) ? std::optional(c.road) : std::nullopt;
    }

    const WatchCommand& command_;
    const antiskid::can::Layout& layout_;
    BusRecorder bus_;
    RigTime rig_time_;
    StripChart chart_;
    WatchedCampaign seen_;
    double phase_began_s_ = 0.0;
    Time next_ledger_{};
};

void print(const std::string& text) {
    fmt::print("{}\n", text);
    (void)std::fflush(stdout);
}

std::string block(const Watch& watch) {
    std::string text;
    for (const std::string& line : watch_screen(watch.seen(), watch.chart())) text += (text.empty() ? "" : "\n") + line;
    return text;
}

std::filesystem::path scenario_file(const WatchCommand& command) {
    if (!command.scenario.empty()) return command.scenario;
    if (command.directory.empty()) throw UsageError("say what to watch: the folder of a campaign, or --scenario FILE of a single maneuver");
    return command.config / "scenarios" / (newest_campaign(ledger_file(command.directory)).scenario + ".toml");
}

}  // namespace

int watch_rig(const WatchCommand& command) {
    constexpr Time kLook{50'000'000};
    constexpr Time kDraw{250'000'000};
    constexpr Time kLine{1'000'000'000};
    constexpr Time kMin{600'000'000};    // of --once: speeds need a few edges
    constexpr Time kMax{1'500'000'000};  // of --once, for a bridge that is not heard
    const antiskid::can::Layout layout = antiskid::LayoutFiles(command.config, command.dbc, command.binding).load();
    const Scenario scenario = load_scenario(scenario_file(command), command.config);
    antiskid::host::StopSignals stops;
    Watch watch(command, layout, meter_parameters(scenario, antiskid::load_controller_config(scenario.controller)));
    watch.scenario(scenario.name);
    const bool live = command.json.empty() && !command.once && ::isatty(STDOUT_FILENO) == 1;
    Terminal terminal(STDOUT_FILENO, live);
    const auto steady = [] { return std::chrono::duration_cast<Time>(std::chrono::steady_clock::now().time_since_epoch()); };
    const Time began = steady();
    Time next = began + (live ? kDraw : kLine);
    while (stops.count() == 0) {
        std::this_thread::sleep_for(kLook);
        const Time now = steady();
        watch.look(now);
        if (command.once) {
            const bool is_heard = received(watch.seen().bridge);
            if (now - began < (is_heard ? kMin : kMax)) continue;
            if (command.json != "-") print(block(watch));
            settings::deliver(command.json, watch_json(watch.seen()));
            return is_heard ? 0 : 1;
        }
        if (now < next) continue;
        next += live ? kDraw : kLine;
        if (live)
            terminal.draw(watch_screen(watch.seen(), watch.chart()));
        else
            print(command.json.empty() ? watch_line(watch.seen()) : watch_json(watch.seen()));
        if (std::ferror(stdout) != 0) return 0;  // whoever read it has gone
    }
    return 0;
}

}  // namespace rig::bridge
