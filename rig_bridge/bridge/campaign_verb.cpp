#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>
#include <stdexcept>

#include "rig_bridge/bridge/bridge_panel.hpp"
#include "rig_bridge/bridge/bridge_setup.hpp"
#include "rig_bridge/bridge/hold.hpp"
#include "rig_bridge/bridge/landings_left.hpp"
#include "rig_bridge/bridge/maneuver_record.hpp"
#include "rig_bridge/bridge/realtime.hpp"
#include "rig_bridge/bridge/rig_hold.hpp"
#include "rig_bridge/bridge/session.hpp"
#include "rig_bridge/bridge/start_checks.hpp"
#include "rig_bridge/bridge/status.hpp"
#include "rig_bridge/bridge/verbs.hpp"
#include "rig_bridge/bridge/view.hpp"
#include "rig_bridge/bridge/wall_clock.hpp"
#include "rig_bridge/bridge/wear_regulation.hpp"
#include "rig_bridge/record/bus_log.hpp"
#include "rig_bridge/record/capture.hpp"
#include "rig_bridge/record/health_watch.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/replay/log_meter.hpp"

namespace rig::bridge {

namespace {

/// Makes kFoundLog in `folder`, 0.3 s of the bus; nothing where it is there already, nobody sends, or the interface is not to be had.
void record_found_bus(const BridgeSetup& setup, const std::filesystem::path& folder) {
    using std::chrono::steady_clock;
    const std::filesystem::path file = folder / replay::kFoundLog;
    if (std::filesystem::exists(file)) return;
    try {
        constexpr antiskid::can::Time kTurn{20'000'000};
        record::Capture capture(setup.options.interface);
        record::BusLog log(file, setup.options.interface);
        const auto end = steady_clock::now() + std::chrono::milliseconds(300);
        while (steady_clock::now() < end) {
            (void)capture.wait(kTurn);
            for (const record::CapturedFrame& frame : capture.receive()) log.write(frame);
        }
        if (!log.finish() || log.frames() == 0) std::filesystem::remove(file);
    } catch (const std::runtime_error&) {
        // The checks before the start name what is wrong with the interface.
    }
}

std::string now_text() {
    return iso_8601(std::chrono::system_clock::now());
}

/// A campaign as one session of the program runs it.
class CampaignRun {
  public:
    CampaignRun(const BridgeSetup& setup, const CampaignCommand& command, std::string name, antiskid::host::StopSignals& stops, Terminal& terminal,
                record::Ledger& ledger, const std::optional<WearRegulation>& regulation, record::HealthWatch* watch, BridgePanel* panel)
        : setup_(setup),
          command_(command),
          name_(std::move(name)),
          stops_(stops),
          terminal_(terminal),
          ledger_(ledger),
          regulation_(regulation),
          watch_(watch),
          panel_(panel),
          judge_(command.rules),
          session_(setup, stops, terminal, panel) {}

    int run() {
        for (;;) {
            while_held();
            if (stops_.count() > 0) return interrupted();
            const auto attempt = next();
            if (!attempt) return 0;
            const Ran ran = one(*attempt);
            if (!ran.record_error.empty()) {
                const std::string lost = fmt::format("maneuver {} does not count, its record is not whole: {}", attempt->number, ran.record_error);
                terminal_.say("rig-bridge: " + lost);
                session_.tell_of_abort(ran, attempt->folder, lost);
                return stops_.count() > 0 ? interrupted() : 1;
            }
            const record::Health health = watch_ == nullptr ? record::Health{} : watch_->newest();
            const Decision decision = judge_.after(ran.summary, health);
            const std::string reason = decision.reason + (ran.note.empty() ? "" : "; " + ran.note);
            if (!decision.reason.empty()) terminal_.say("rig-bridge: " + reason);
            if (ran.summary.outcome != name(rig::Phase::finished)) session_.tell_of_abort(ran, attempt->folder, reason);
            for (const std::string& warning : ran.summary.warnings)
                terminal_.say(fmt::format("rig-bridge: maneuver {}: {}", attempt->number, warning));
            if (ran.summary.outcome == name(rig::Phase::finished))
                terminal_.say(fmt::format("maneuver {} finished: mean torque {:.1f} N m, mean friction {:.4f}, {:.3f} MJ in all{}",
                                          ran.summary.number, ran.summary.figures.mean_torque_Nm, ran.summary.figures.mean_friction,
                                          ran.summary.cumulative_energy_J * 1e-6, watch_ == nullptr ? "" : "; brake " + health_text(health)));
            if (!ran.outside.empty()) terminal_.say(fmt::format("rig-bridge: maneuver {} is out of tolerance: {}", attempt->number, ran.outside));
            if (regulation_) terminal_.say(shared_);
            const bool interrupts = stops_.count() > 0;
            if (ran.summary.outcome != name(rig::Phase::finished) && (interrupts || decision.verdict == CampaignState::fault))
                session_.watch_rim(setup_.scenario.mean.standstill_mps);
            if (interrupts) return interrupted();
            if (decision.verdict == CampaignState::fault || decision.verdict == CampaignState::abnormal) return 1;
            if (decision.verdict == CampaignState::worn) return 0;
        }
    }

  private:
    [[nodiscard]] std::optional<record::Attempt> next() {
        std::optional<record::Attempt> attempt;
        session_.meanwhile([&] {
            const auto number = ledger_.next_number();
            if (!number) return;
            if (setup_.scenario.mean.law == rig::BrakeLaw::slip) slip_reference_ = setup_.scenario.mean.slip_reference;
            if (regulation_) {
                const wear::Regulator shares = regulator();
                slip_reference_ = shares.reference();
                shared_ = line(shares);
            }
            if (panel_ != nullptr && !command_.wear_model.empty())
                landings_left_ = landings_left(command_.wear_model, record::read_ledger(ledger_file(command_.rig.out), name_),
                                               command_.rules.min_friction.value_or(0.0));
            attempt = ledger_.begin(*number, now_text(), slip_reference_);
            if (panel_ != nullptr) panel_->begun();
        });
        return attempt;
    }
    [[nodiscard]] ManeuverRequest request(const record::Attempt& attempt) const {
        const std::int64_t finished = ledger_.finished_count();
        rig::Plan maneuver = plan(setup_.scenario, setup_.options.seed, attempt.number);
        maneuver.slip_reference = slip_reference_.value_or(maneuver.slip_reference);
        return {.plan = std::move(maneuver),
                .campaign = name_,
                .number = attempt.number,
                .folder = attempt.folder,
                .specimen = ledger_.specimen(),
                .taken_J = ledger_.cumulative_energy_J(),
                .view = CampaignView{.number = attempt.number,
                                     .finished = finished,
                                     .planned = command_.rules.maneuvers,
                                     .left_s = pace_.left_s(command_.rules.maneuvers - finished),
                                     .regulation = shared_,
                                     .health = watch_ == nullptr ? "" : health_text(watch_->newest()),
                                     .landings_left = landings_left_}};
    }
    /// Everything is off meanwhile.
    void while_held() {
        constexpr std::chrono::milliseconds kLook{200};
        std::optional<Hold> hold;
        bool said = false;
        do {
            if (said) session_.rest(kLook);
            session_.meanwhile([&] { hold = ledger_.next_number() ? read_hold(command_.rig.out) : std::nullopt; });
            session_.rest_note(hold ? to_text(*hold) : "");
            if (hold && !said)
                terminal_.say(fmt::format("rig-bridge: {}; `rig-bridge resume {}` lets it go on", to_text(*hold), command_.rig.out.string()));
            if (!hold && said) terminal_.say("rig-bridge: goes on after the hold");
            said = hold.has_value();
        } while (hold && stops_.count() == 0);
    }
    [[nodiscard]] Ran one(const record::Attempt& attempt) {
        const auto began = std::chrono::steady_clock::now();
        ManeuverRequest what;
        session_.meanwhile([&] { what = request(attempt); });
        Ran ran = session_.run(what);
        session_.meanwhile([&] {
            enter(ledger_, attempt.folder, ran.summary);
            if (!ran.record_error.empty()) return;
            if (watch_ != nullptr && ran.summary.outcome == name(rig::Phase::finished) && !record::off_conditions(ran.summary))
                ledger_.judge(ran.summary.number, watch_->after(ran.summary));
            if (regulation_) {
                const wear::Regulator shares = regulator();
                shared_ = line(shares);
                write_regulation(regulation_file(command_.rig.out, name_), shares);
            }
        });
        pace_.add(std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
        return ran;
    }
    /// From the ledger alone, so that a bridge that was killed goes on with the same reference.
    [[nodiscard]] wear::Regulator regulator() const { return regulation_->after(record::read_ledger(ledger_file(command_.rig.out), name_)); }
    [[nodiscard]] int interrupted() const { return 128 + stops_.number(); }

    const BridgeSetup& setup_;
    const CampaignCommand& command_;
    std::string name_;
    antiskid::host::StopSignals& stops_;
    Terminal& terminal_;
    record::Ledger& ledger_;
    const std::optional<WearRegulation>& regulation_;
    std::optional<double> slip_reference_;  // of the maneuver that runs, where the law is slip
    std::string shared_;                    // how wear is shared, for people
    record::HealthWatch* watch_;            // none: nobody judges the brake
    BridgePanel* panel_;
    std::string landings_left_;  // for the panel
    CampaignJudge judge_;
    Pace pace_;
    Session session_;
};

void tell(const record::Resumed& resumed, std::int64_t finished, Terminal& terminal) {
    for (const std::string& change : resumed.changed) terminal.say("rig-bridge: goes on although " + change);
    for (const std::int64_t number : resumed.adopted) terminal.say(fmt::format("rig-bridge: maneuver {} had finished and is entered now", number));
    for (const std::int64_t number : resumed.unfinished)
        terminal.say(fmt::format("rig-bridge: maneuver {} was left unfinished and is run again; what its log says counts", number));
    if (!resumed.created) terminal.say(fmt::format("rig-bridge: resumes, {} maneuvers finished", finished));
}

/// Of a maneuver that a dead bridge left, from its bus.log.
std::optional<record::Summary> summary_of_log(const record::Attempt& left, const BridgeSetup& setup) {
    const std::filesystem::path log = replay::log_in(left.folder);
    if (log.empty()) return std::nullopt;
    record_found_bus(setup, left.folder);
    return summary_of_left(setup, left, log);
}

/// The last maneuver before the bridge died may have reached the wear limit or shown an abnormal brake.
Decision before(const CampaignRules& rules, const std::filesystem::path& file, const std::string& name) {
    const std::vector<record::LedgerRow> rows = record::read_ledger(file, name);
    const auto last = std::find_if(rows.rbegin(), rows.rend(), [](const record::LedgerRow& row) {
        return row.state == record::RowState::finished && !record::off_conditions(row.summary);
    });
    return last == rows.rend() ? Decision{} : CampaignJudge(rules).before(last->summary, last->health);
}

/// Health and regulation know one brake and disc.
void reject_mixed_wear(const CampaignCommand& command, const std::vector<record::LedgerRow>& rows, const record::Specimen& now) {
    if (command.wear_model.empty() && !command.regulate) return;
    const auto another = [](const std::string& was, const std::string& is) { return !was.empty() && was != is; };
    for (const record::LedgerRow& row : rows)
        if (const record::Specimen& was = row.summary.specimen; another(was.brake, now.brake) || another(was.disc, now.disc))
            throw UsageError(
                fmt::format("maneuver {} was of brake '{}' and disc '{}', now they are '{}' and '{}': their wear is not mixed; give a campaign of "
                            "its own with --name",
                            row.attempt.number, was.brake, was.disc, now.brake, now.disc));
}

}  // namespace

int run_campaign(const CampaignCommand& command) {
    std::optional<wear::RegulationConfig> asked;
    if (command.regulate) {
        asked = wear::load_regulation_config(command.regulation.empty() ? command.rig.config / "regulation.toml" : command.regulation);
        if (!command.surfaces.empty()) asked->surfaces = wear::surfaces_of(asked->floor, command.surfaces);
    }
    const BridgeSetup setup = load_setup(command.rig, asked ? asked->files : std::vector<std::filesystem::path>{});
    std::optional<WearRegulation> shared;
    if (asked) shared.emplace(*asked, setup.scenario);
    const std::string name = command.name.empty() ? setup.scenario.name : command.name;
    const std::filesystem::path file = ledger_file(command.rig.out);
    const RigHold hold(hold_places(setup), holder_text("campaign", command.rig.out));
    antiskid::host::StopSignals stops;
    Terminal terminal(STDERR_FILENO, wanted(setup.options.view));
    record::Ledger ledger(file);
    const record::Resumed resumed = ledger.open_campaign({.name = name,
                                                          .scenario = setup.scenario.name,
                                                          .seed = setup.options.seed,
                                                          .planned = command.rules.maneuvers,
                                                          .config_hash = setup.config_hash,
                                                          .version = ANTISKID_VERSION,
                                                          .created = now_text(),
                                                          .specimen = command.rig.specimen},
                                                         command.changed ? record::IfChanged::go_on : record::IfChanged::reject,
                                                         [&](const record::Attempt& left) { return summary_of_log(left, setup); });
    tell(resumed, ledger.finished_count(), terminal);
    reject_mixed_wear(command, record::read_ledger(file, name), ledger.specimen());
    std::optional<record::HealthWatch> watch;
    if (!command.wear_model.empty()) {
        watch.emplace(command.wear_model);
        terminal.say("rig-bridge: the brake is judged by brakes " + watch->learnt_from());
        record::catch_up(*watch, ledger, record::read_ledger(file, name));
    }
    if (const Decision decision = before(command.rules, file, name); decision.verdict != CampaignState::go_on) {
        terminal.say("rig-bridge: " + decision.reason);
        return decision.verdict == CampaignState::worn ? 0 : 1;
    }
    if (!ledger.next_number()) {
        fmt::print("{}", status_text(file));
        return 0;
    }
    check_start(setup, command.rig.out);
    if (!command.held_by.empty() && !read_hold(command.rig.out))
        write_hold(command.rig.out, {.who = command.held_by, .since = now_text(), .why = "waits to be started"});
    int status = 1;
    try {
        std::optional<BridgePanel> panel;
        if (!setup.options.panel.empty()) panel.emplace(setup, command.rig.out, stops, terminal);
        if (panel && !record::read_ledger(file, name).empty()) panel->begun();
        enter_realtime(setup.options.priority, terminal);
        CampaignRun run(setup, command, name, stops, terminal, ledger, shared, watch ? &*watch : nullptr, panel ? &*panel : nullptr);
        status = run.run();
    } catch (const EndAtOnce&) {
        terminal.say("rig-bridge: ended at once; the PLC's watchdog and the controller's time-outs make the rig safe");
        return 128 + stops.number();
    }
    fmt::print("{}", status_text(file));
    return status;
}

}  // namespace rig::bridge
