#include "rig_bridge/bridge/session.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <utility>

#include "firmware/can/socket_can.hpp"
#include "firmware/can/value_names.hpp"
#include "rig_bridge/bridge/abort_hook.hpp"
#include "rig_bridge/bridge/next_step.hpp"
#include "rig_bridge/bridge/panel_state.hpp"
#include "rig_bridge/bridge/view_model.hpp"
#include "rig_bridge/bridge/wall_clock.hpp"
#include "rig_bridge/record/live_file.hpp"
#include "rig_bridge/rig/acceptance.hpp"

namespace rig::bridge {

using antiskid::can::Time;
using rig::Phase;

class Session::ModbusPlc final : public Plc {
  public:
    ModbusPlc(const RegisterMap& map, const std::string& address, std::function<modbus::ClockTime()> now, modbus::Polling polling)
        : client_(map, modbus::parse_plc_address(address), std::move(now), polling) {}
    void read_all() { client_.read_all(); }
    void write_turn(std::uint16_t number) { client_.write_turn(number); }
    void command(const CommandedValues& wanted) override { client_.command(wanted); }
    [[nodiscard]] modbus::Snapshot snapshot() const override { return client_.snapshot(); }

  private:
    modbus::ModbusClient client_;
};

namespace {

/// At the abort: the phase that it ended, and what PLC, bus or controller said then.
std::string how_it_was(Phase phase, const Moment& moment) {
    const std::string note = note_of(moment);
    const auto state = static_cast<std::size_t>(moment.bus.view.controller.state);
    std::string text = "in " + std::string(name(phase));
    if (moment.inputs.controller_fresh) text += ", controller in " + std::string(antiskid::can::kStateNames[state]);
    return note.empty() ? text : text + ", " + note;
}

}  // namespace

Session::Session(const BridgeSetup& setup, antiskid::host::StopSignals& stops, Terminal& terminal, BridgePanel* panel)
    : setup_(setup),
      stops_(stops),
      terminal_(terminal),
      panel_(panel),
      lockstep_(setup.options.lockstep ? std::make_optional<Lockstep>(setup.layout, Time(std::llround(setup.meter.period_s * 1e9)), Node::kStep,
                                                                      std::chrono::milliseconds(setup.options.answer_timeout_ms))
                                       : std::nullopt),
      plc_(std::make_unique<ModbusPlc>(
          setup.map, setup.options.plc, [this] { return lockstep_ ? lockstep_->now() : clock_.now(); },
          lockstep_ ? modbus::Polling::turns : modbus::Polling::own_thread)),
      bus_([&setup] { return std::make_unique<antiskid::can::SocketCan>(setup.options.interface, std::span<const std::uint16_t>{}); }),
      recorder_(
          setup.options.interface, setup.layout, setup.meter, [this] { (void)bus_.service(); }, lockstep_ ? &*lockstep_ : nullptr),
      node_(setup.layout, setup.meter.period_s, setup.limits, *plc_, recorder_, bus_),
      timer_(clock_, Node::kStep) {
    if (!lockstep_) return;
    plc_->read_all();
    plc_->write_turn(kJoined);
}

Session::~Session() = default;

const Moment& Session::step(rig::Sequencer* sequencer, const ManeuverRequest* request) {
    if (lockstep_)
        recorder_.await_turn([this] { return stops_.count() > 1; });
    else
        (void)timer_.wait();
    const int stops = stops_.count();
    if (stops > 1) throw EndAtOnce{};
    if (lockstep_) plc_->read_all();
    const std::int64_t number = request == nullptr ? 0 : request->number;
    const Moment& moment = node_.step(sequencer, {.number = number, .abort = abort_ || stops > 0, .reset = setup_.options.reset},
                                      lockstep_ ? lockstep_->now() : clock_.now());
    if (lockstep_) plc_->write_turn(lockstep_->end_turn());
    if (panel_ != nullptr) tell_panel(moment, request == nullptr && sequencer == nullptr);
    if (const std::string second = second_sender_text(moment.bus); !second.empty() && !second_sender_) {
        terminal_.say(fmt::format("rig-bridge: {}. Next: end one of them", second));
        second_sender_ = true;
    }
    return moment;
}

void Session::tell_panel(const Moment& moment, bool resting) {
    panel_->feed().sample(live_sample(moment));
    const double now_s = std::chrono::duration<double>(moment.now).count();
    if (!resting || !panel_->feed().state_due(now_s)) return;
    ViewModel view = view_of(moment, node_.limits());
    view.scenario = setup_.scenario.title;
    view.phase = phase_;
    view.abort = aborted_by_;
    if (!rest_note_.empty()) view.note = rest_note_;
    panel_->state(view, moment, now_s);
}

void Session::rest(Time duration) {
    const Time begin = step(nullptr, nullptr).now;
    while (stops_.count() == 0 && node_.moment().now - begin < duration) (void)step(nullptr, nullptr);
}

void Session::meanwhile(const std::function<void()>& work) {
    meanwhile(work, nullptr, nullptr);
}

void Session::meanwhile(const std::function<void()>& work, rig::Sequencer* sequencer, const ManeuverRequest* request) {
    if (lockstep_) return work();
    auto done = std::async(std::launch::async, work);
    while (done.wait_for(std::chrono::seconds(0)) != std::future_status::ready) (void)step(sequencer, request);
    done.get();
}

void Session::show(const ManeuverRequest& request, const Moment& moment, const std::string& waiting_for) {
    if (moment.outputs.phase != phase_) {
        phase_ = moment.outputs.phase;
        phase_began_s_ = moment.rig_s;
    }
    if (!view_due(moment, moment.outputs.phase, moment.outputs.abort)) return;
    ViewModel view = view_of(moment, node_.limits());
    view.scenario = setup_.scenario.title;
    view.campaign = request.view;
    view.prescribed_mps = request.plan.speed_mps;
    view.time_s = moment.rig_s - began_s_;
    view.phase_s = moment.rig_s - phase_began_s_;
    if (!waiting_for.empty()) view.note = waiting_for;
    view.record_lost = !record_error_.empty();
    present(view, moment);
}

bool Session::view_due(const Moment& moment, Phase phase, rig::Abort abort) const {
    const double now_s = std::chrono::duration<double>(moment.now).count();
    return terminal_.due(now_s, phase, abort) || (panel_ != nullptr && panel_->feed().state_due(now_s));
}

void Session::present(const ViewModel& view, const Moment& moment) {
    const double now_s = std::chrono::duration<double>(moment.now).count();
    if (terminal_.due(now_s, view.phase, view.abort)) terminal_.show(view, now_s);
    if (panel_ != nullptr && panel_->feed().state_due(now_s)) panel_->state(view, moment, now_s);
}

void Session::await_ready(const ManeuverRequest& request, const ManeuverRun& run) {
    while (stops_.count() == 0) {
        const Moment& m = step(nullptr, &request);
        if (run.ready(m)) return;
        show(request, m, run.waits_for(m));
    }
}

void Session::sequence(const ManeuverRequest& request, ManeuverRun& run, record::SampleLog& samples) {
    Phase before = Phase::idle;
    Phase ended = before;  // by the abort
    aborted_by_ = rig::Abort::none;
    while (!run.over()) {
        const Moment& m = step(run.sequencer(), &request);
        trace_.record(m);
        // A label of real time, as in bus.log, also in lockstep.
        if (run.follow(m, (lockstep_ ? clock_.now() : m.now) + m.bus.wall_minus_monotonic, samples)) recorder_.end();
        record_error_ = run.record_error();
        abort_ = !record_error_.empty();
        if (m.outputs.abort != aborted_by_) {
            if (aborted_by_ == rig::Abort::none) ended = before;
            aborted_by_ = m.outputs.abort;
            note_ = how_it_was(ended, m);
            advice_ = advice(aborted_by_, ended, m.bus.view.controller.faults);
            if (const std::string note = note_of(m); !note.empty()) advice_ += "\n  " + note;
            if (!setup_.options.quiet) terminal_.ring();
            terminal_.say("rig-bridge: " + advice_);
        }
        before = m.outputs.phase;
        show(request, m, record_error_);
    }
}

void Session::watch_rim(double standstill_mps) {
    constexpr double kUnknown_s = 3.0;  // a link that is lost may come back
    double known_s = node_.moment().rig_s;
    std::optional<double> rim_mps = rim_speed_mps(node_.moment());
    while (stops_.count() == 0 && !setup_.options.leave_turning) {
        const Moment& m = step(nullptr, nullptr);
        rim_mps = rim_speed_mps(m);
        if (rim_mps) known_s = m.rig_s;
        if (rim_mps ? *rim_mps < standstill_mps : m.rig_s - known_s > kUnknown_s) break;
        if (!view_due(m, Phase::aborted, aborted_by_)) continue;
        ViewModel view = view_of(m, node_.limits());
        view.scenario = setup_.scenario.title;
        view.phase = Phase::aborted;
        view.abort = aborted_by_;
        view.time_s = m.rig_s - began_s_;
        view.phase_s = m.rig_s - phase_began_s_;
        view.note = rim_text(rim_mps, standstill_mps) + "; Ctrl-C ends the program at once";
        present(view, m);
    }
    terminal_.keep_block();
    terminal_.say("rig-bridge: " + rim_text(rim_mps, standstill_mps));
}

void Session::tell_of_abort(const Ran& ran, const std::filesystem::path& folder, const std::string& outcome) {
    if (setup_.options.on_abort.empty()) return;
    const std::string next = ran.record_error.empty() ? ran.advice : ran.record_error + ". Next: make room, or give another disk; start again";
    const std::vector<std::string> environment = environment_of({.outcome = outcome,
                                                                 .cause = ran.summary.outcome,
                                                                 .next_step = next,
                                                                 .campaign = ran.summary.campaign,
                                                                 .maneuver = ran.summary.number,
                                                                 .folder = folder});
    std::string failure;
    meanwhile([&] { failure = run_hook(setup_.options.on_abort, environment); });
    if (!failure.empty()) terminal_.say("rig-bridge: --on-abort failed: " + failure);
}

Ran Session::run(const ManeuverRequest& request) {
    abort_ = false;
    second_sender_ = false;
    record_error_.clear();
    note_.clear();
    advice_.clear();
    trace_ = {};
    phase_ = Phase::idle;
    began_s_ = phase_began_s_ = step(nullptr, &request).rig_s;
    ManeuverRun run(request.plan, began_s_);
    await_ready(request, run);

    run.begin();
    const std::string started = iso_8601(std::chrono::system_clock::now());
    recorder_.begin(request.folder / "bus.log");
    constexpr std::size_t kQueue_bytes = std::size_t{1} << 20U;  // a minute
    record::SampleLog samples(
        std::make_unique<record::LiveFile>(request.folder / "modbus.csv", record::LiveFileOptions{.queue_bytes = kQueue_bytes}));
    sequence(request, run, samples);
    Ran ran{.summary = {}, .record_error = {}, .trace = {}, .note = note_, .advice = advice_, .outside = {}};
    ran.trace = std::move(trace_);
    std::unique_ptr<Recording> recording;
    while (!recording) {
        (void)step(run.sequencer(), &request);
        recording = recorder_.take();
    }
    meanwhile([&] { run.finish(recording->log, samples); }, run.sequencer(), &request);
    terminal_.keep_block();
    record_error_ = run.record_error();
    ran.record_error = record_error_;

    ran.summary = summary_of(setup_, request, *run.sequencer(), started, *recording, record_error_.empty());
    if (run.sequencer()->phase() == Phase::finished) ran.outside = what_is_outside(acceptance(setup_.scenario, request.plan), ran.summary.figures);
    return ran;
}

}  // namespace rig::bridge
