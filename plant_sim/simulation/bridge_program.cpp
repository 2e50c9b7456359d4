#include "plant_sim/simulation/bridge_program.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <new>
#include <stdexcept>
#include <utility>

#include "rig_bridge/bridge/wall_clock.hpp"

namespace plant_sim::simulation {

using antiskid::can::Frame;
using antiskid::can::Time;
using rig::Phase;
using rig::record::Attempt;
using rig::record::Summary;

namespace {

// As Session and LiveFile have them.
constexpr int kTail = 15;
constexpr Time kIntroduction{500'000'000};
constexpr Time kWrite{100'000'000};
constexpr Time kSync{1'000'000'000};

}  // namespace

BridgeProgram::BridgeProgram(const rig::bridge::BridgeSetup& setup, BridgeCampaign campaign, BridgeMachine machine,
                             std::unique_ptr<rig::modbus::PlcLine> line, CampaignBooks& books, BridgeMistake mistake)
    : setup_(setup),
      campaign_(std::move(campaign)),
      machine_(std::move(machine)),
      books_(books),
      mistake_(mistake),
      stamps_([this]() -> antiskid::can::ClockReading {
          const Time now = machine_.now();
          return {.wall_minus_monotonic = machine_.wall_minus_monotonic(now), .monotonic = now};
      }),
      listener_(setup.layout, setup.meter),
      plc_(setup.map, std::move(line), [this] { return time(); }),
      node_(setup.layout, setup.meter.period_s, setup.limits, plc_, feed_, machine_.sends) {
    open();
}

void BridgeProgram::open() {
    const auto product = machine_.gate.product();
    ledger_ = std::make_unique<rig::record::Ledger>(kSimulatedLedger, rig::record::LedgerOptions{.busy_timeout_ms = 0, .storage = machine_.storage});
    const rig::record::Resumed resumed = ledger_->open_campaign({.name = kSimulatedCampaign,
                                                                 .scenario = setup_.scenario.name,
                                                                 .seed = setup_.options.seed,
                                                                 .planned = campaign_.planned,
                                                                 .config_hash = setup_.config_hash,
                                                                 .version = ANTISKID_VERSION,
                                                                 .created = wall_text()},
                                                                rig::record::IfChanged::reject, [this](const Attempt& left) { return meter(left); });
    if (mistake_ == BridgeMistake::counts_by_itself) next_ = ledger_->finished_count() + static_cast<std::int64_t>(resumed.unfinished.size()) + 1;
}

void BridgeProgram::tell_books(const std::function<void()>& what) {
    const auto simulation = machine_.gate.simulation();
    what();
}

Time BridgeProgram::time() const {
    const Time now = machine_.now();
    return mistake_ == BridgeMistake::waits_by_wall_clock ? now + machine_.wall_minus_monotonic(now) : now;
}

std::string BridgeProgram::wall_text() const {
    const Time now = machine_.now();
    return rig::bridge::iso_8601(std::chrono::system_clock::time_point(now + machine_.wall_minus_monotonic(now)));
}

std::optional<Summary> BridgeProgram::meter(const Attempt& left) {
    if (mistake_ == BridgeMistake::forgets_energy_left) return std::nullopt;
    if (!std::filesystem::exists(machine_.storage->status(left.folder / "bus.log"))) return std::nullopt;
    std::optional<PassingFile> file;
    {
        const auto simulation = machine_.gate.simulation();
        file.emplace(log_bytes(left, *machine_.storage));
    }
    auto summary = rig::bridge::summary_of_left(setup_, left, file->path());
    if (!summary) return std::nullopt;
    const auto simulation = machine_.gate.simulation();
    const double counted_J = rig::record::counted_energy_J(*summary);
    books_.of(left).measured_J.insert(counted_J);
    if (mistake_ == BridgeMistake::counts_energy_left_twice) left_J_ = counted_J;
    return summary;
}

void BridgeProgram::poll() {
    if (mistake_ == BridgeMistake::proves_life_without_loop) plc_.client.alive();
    plc_.client.round();
}

bool BridgeProgram::recording() const {
    return run_ && run_->recording && run_->resting <= kTail;
}

void BridgeProgram::hear() {
    std::vector<Frame>* const known = recording() ? &books_.of(attempt_).frames : nullptr;
    std::array<Frame, 64> frames{};
    for (std::size_t count = frames.size(); count == frames.size();) {
        count = machine_.hears.receive(frames);
        stamps_.next_batch();
        for (std::size_t i = 0; i < count; ++i) {
            rig::record::CapturedFrame one{.frame = frames[i]};
            one.frame.received += machine_.wall_minus_monotonic(frames[i].received);
            const Time came = stamps_.monotonic(one.frame.received);
            if (mistake_ == BridgeMistake::waits_by_wall_clock)
                frames[i].received = one.frame.received;
            else
                frames[i].received = came;
            listener_.accept(frames[i]);
            if (known == nullptr) continue;
            if (mistake_ == BridgeMistake::keeps_wall_clock_stamps) run_->recording->label = rig::record::StampLabel(one.frame.received - came);
            run_->recording->take(one, came);
            known->push_back(one.frame);
        }
    }
    feed_.heard.up = machine_.hears.status().up;
    listener_.tell(feed_.heard, time(), true);
    if (run_ && run_->recording) write_files();
}

void BridgeProgram::write_files() {
    const Time now = machine_.now();
    if (now < next_write_) return;
    next_write_ = now + kWrite;
    run_->bus_log->flush();
    run_->modbus_csv->flush();
    if (now >= next_sync_) {
        next_sync_ = now + kSync;
        run_->bus_log->sync();
        if (run_->bus_log->error().empty()) books_.synced(attempt_);
        run_->modbus_csv->sync();
    }
    feed_.heard.missing = run_->recording->log.missing();
    if (feed_.heard.missing != 0) feed_.heard.recording_error = run_->recording->log.error();
}

const rig::bridge::Moment& BridgeProgram::step() {
    rig::Sequencer* const sequencer = run_ && run_->sequencer ? &*run_->sequencer : nullptr;
    const rig::bridge::Moment& moment = node_.step(
        sequencer,
        {.number = run_ ? attempt_.number : 0, .abort = run_ && !run_->record_error.empty(), .reset = mistake_ != BridgeMistake::leads_no_plc_back},
        time());
    if (sequencer != nullptr)
        follow(moment);
    else if (!run_)
        begin();
    else if (machine_.now() >= run_->introduced)
        begin_record();
    return moment;
}

std::optional<std::int64_t> BridgeProgram::next_number() const {
    if (mistake_ != BridgeMistake::counts_by_itself) return ledger_->next_number();
    return next_ <= campaign_.planned ? std::optional(next_) : std::nullopt;
}

void BridgeProgram::begin() {
    const auto product = machine_.gate.product();
    const auto number = next_number();
    complete_ = !number;
    if (complete_) return;
    attempt_ = ledger_->begin(*number, wall_text());
    tell_books([&] { books_.begun(attempt_); });
    run_.emplace(Run{.request = {.plan = campaign_.plan,
                                 .campaign = kSimulatedCampaign,
                                 .number = attempt_.number,
                                 .folder = attempt_.folder,
                                 .specimen = ledger_->specimen(),
                                 .taken_J = ledger_->cumulative_energy_J(),
                                 .view = std::nullopt},
                     .introduced = machine_.now() + kIntroduction});
}

void BridgeProgram::begin_record() {
    const auto product = machine_.gate.product();
    const Time now = machine_.now();
    Run& run = *run_;
    run.started = wall_text();
    auto bus_log = std::make_unique<rig::record::AppendFile>(attempt_.folder / "bus.log", *machine_.storage);
    run.bus_log = bus_log.get();
    run.recording = std::make_unique<rig::bridge::Recording>(std::move(bus_log), setup_.options.interface, setup_.layout, setup_.meter,
                                                             machine_.wall_minus_monotonic(now));
    auto modbus_csv = std::make_unique<rig::record::AppendFile>(attempt_.folder / "modbus.csv", *machine_.storage);
    run.modbus_csv = modbus_csv.get();
    run.samples = std::make_unique<rig::record::SampleLog>(std::move(modbus_csv));
    feed_.heard.wall_minus_monotonic = run.recording->label.of(Time{});
    feed_.heard.missing = 0;
    next_write_ = now + kWrite;
    next_sync_ = now + kSync;
    run.sequencer.emplace(run.request.plan);
}

void BridgeProgram::follow(const rig::bridge::Moment& moment) {
    Run& run = *run_;
    if (run.resting <= kTail && moment.plc.counters.polls != std::exchange(run.polls, moment.plc.counters.polls))
        run.samples->write(moment.now + moment.bus.wall_minus_monotonic, moment.plc.values);
    const std::string lost = moment.bus.missing != 0 ? moment.bus.recording_error : run.samples->error();
    if (!lost.empty() && run.resting <= kTail && run.record_error.empty()) run.record_error = lost;
    const bool rests = moment.outputs.phase == Phase::cool_down || moment.outputs.phase == Phase::finished || moment.outputs.phase == Phase::aborted;
    if (rests && run.resting <= kTail) ++run.resting;
    if (run.sequencer->over() && run.resting > kTail) close();
}

void BridgeProgram::close() {
    const auto product = machine_.gate.product();
    Run& run = *run_;
    const bool late = mistake_ == BridgeMistake::enters_before_it_is_synced;
    bool whole = true;
    if (late)
        run.recording->log.flush();
    else
        whole = run.recording->log.finish();
    if (whole && !late) tell_books([&] { books_.synced(attempt_); });
    whole = run.samples->finish() && whole;
    if (!whole && run.record_error.empty()) run.record_error = run.recording->log.error() + run.samples->error();
    Summary summary = rig::bridge::summary_of(setup_, run.request, *run.sequencer, run.started, *run.recording, run.record_error.empty());
    if (left_J_ != 0.0) {
        summary.figures.energy_brake_J += std::exchange(left_J_, 0.0);
        summary.cumulative_energy_J = run.request.taken_J + rig::record::counted_energy_J(summary);
    }
    enter(summary);
    if (late) (void)run.recording->log.finish();
    const std::string lost = run.record_error;
    run_.reset();
    if (!lost.empty()) throw std::runtime_error("the record is not whole: " + lost);
    ++next_;
    begin();
}

void BridgeProgram::enter(const Summary& summary) {
    const double counted_J = rig::record::counted_energy_J(summary);
    tell_books([&] { books_.of(attempt_).measured_J.insert(counted_J); });
    try {
        rig::bridge::enter(*ledger_, attempt_.folder, summary, *machine_.storage);
    } catch (const rig::record::LedgerInDoubt&) {
        throw;
    } catch (const rig::record::LedgerError&) {
        tell_books([&] { books_.refused(attempt_); });
        if (mistake_ != BridgeMistake::overlooks_no_memory) throw;
    } catch (const std::bad_alloc&) {
        if (mistake_ != BridgeMistake::overlooks_no_memory) throw;
    }
    if (summary.outcome == rig::name(Phase::finished)) tell_books([&] { books_.finished(attempt_, counted_J); });
}

}  // namespace plant_sim::simulation
