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

// As LiveFile has them.
constexpr Time kWrite{100'000'000};
constexpr Time kSync{1'000'000'000};

}  // namespace

BridgeProgram::BridgeProgram(const rig::bridge::BridgeSetup& setup, BridgeCampaign campaign, BridgeMachine machine,
                             std::unique_ptr<rig::modbus::PlcLine> line, CampaignAudit& audit, BridgeMistake mistake)
    : setup_(setup),
      campaign_(std::move(campaign)),
      machine_(std::move(machine)),
      audit_(audit),
      mistake_(mistake),
      listener_(setup.layout, setup.meter,
                [this]() -> antiskid::can::ClockReading { return {.wall_minus_monotonic = offset(), .monotonic = time()}; }),
      plc_(setup.map, std::move(line), [this] { return time(); }),
      node_(setup.layout, setup.meter.period_s, setup.limits, plc_, feed_, machine_.send_bus) {
    open();
}

void BridgeProgram::open() {
    const auto product = machine_.gate.product();
    ledger_ = std::make_unique<rig::record::Ledger>(kSimulatedLedger, rig::record::LedgerOptions{.busy_timeout_ms = 0, .storage = machine_.disk});
    const rig::record::Resumed resumed = ledger_->open_campaign({.name = kSimulatedCampaign,
                                                                 .scenario = setup_.scenario.name,
                                                                 .seed = setup_.options.seed,
                                                                 .planned = campaign_.planned,
                                                                 .config_hash = setup_.config_hash,
                                                                 .version = ANTISKID_VERSION,
                                                                 .created = wall_text()},
                                                                rig::record::IfChanged::reject, [this](const Attempt& left) { return meter(left); });
    if (mistake_ == BridgeMistake::numbers_maneuvers_itself)
        next_ = ledger_->finished_count() + static_cast<std::int64_t>(resumed.unfinished.size()) + 1;
}

void BridgeProgram::outside_product(const std::function<void()>& what) {
    const auto simulation = machine_.gate.simulation();
    what();
}

Time BridgeProgram::time() const {
    const Time now = machine_.now();
    return mistake_ == BridgeMistake::waits_by_wall_clock ? now + machine_.wall_minus_monotonic(now) : now;
}

Time BridgeProgram::offset() const {
    return mistake_ == BridgeMistake::waits_by_wall_clock ? Time{} : machine_.wall_minus_monotonic(machine_.now());
}

std::string BridgeProgram::wall_text() const {
    const Time now = machine_.now();
    return rig::bridge::iso_8601(std::chrono::system_clock::time_point(now + machine_.wall_minus_monotonic(now)));
}

std::optional<Summary> BridgeProgram::meter(const Attempt& left) {
    if (mistake_ == BridgeMistake::forgets_energy_left) return std::nullopt;
    if (!std::filesystem::exists(machine_.disk->status(left.folder / "bus.log"))) return std::nullopt;
    std::optional<MemoryFile> file;
    {
        const auto simulation = machine_.gate.simulation();
        file.emplace(machine_.disk->bytes(left.folder / "bus.log"));
    }
    auto summary = rig::bridge::summary_of_left(setup_, left, file->path());
    if (!summary) return std::nullopt;
    const auto simulation = machine_.gate.simulation();
    const double counted_J = rig::record::counted_energy_J(*summary);
    audit_.of(left).measured_J.insert(counted_J);
    if (mistake_ == BridgeMistake::counts_energy_left_twice) left_J_ = counted_J;
    return summary;
}

void BridgeProgram::poll() {
    if (mistake_ == BridgeMistake::watchdog_without_loop) plc_.client.alive();
    plc_.client.exchange();
}

void BridgeProgram::receive() {
    rig::bridge::Recording* const recording = run_ && run_->maneuver.recording() ? run_->recording.get() : nullptr;
    std::array<Frame, 64> frames{};
    std::array<rig::record::CapturedFrame, frames.size()> captured{};
    for (std::size_t count = frames.size(); count == frames.size();) {
        count = machine_.receive_bus.receive(frames);
        for (std::size_t i = 0; i < count; ++i) {
            captured[i] = {.frame = frames[i]};
            captured[i].frame.received += machine_.wall_minus_monotonic(frames[i].received);
        }
        receive(std::span(captured).first(count), recording);
    }
    feed_.state.up = machine_.receive_bus.status().up;
    listener_.fill(feed_.state, time(), true, recording);
    if (run_ && run_->recording) write_files();
}

void BridgeProgram::receive(std::span<rig::record::CapturedFrame> frames, rig::bridge::Recording* recording) {
    if (mistake_ == BridgeMistake::keeps_wall_clock_stamps && recording != nullptr && !frames.empty())
        recording->label = rig::record::StampLabel(machine_.wall_minus_monotonic(machine_.now()));
    listener_.receive(frames, recording);
    if (recording == nullptr) return;
    std::vector<Frame>& known = audit_.of(attempt_).frames;
    for (const rig::record::CapturedFrame& one : frames) known.push_back(one.frame);
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
        if (run_->bus_log->error().empty()) audit_.synced(attempt_);
        run_->modbus_csv->sync();
    }
}

const rig::bridge::Moment& BridgeProgram::step() {
    rig::bridge::ManeuverRun* const maneuver = run_ ? &run_->maneuver : nullptr;
    rig::Sequencer* const sequencer = maneuver != nullptr ? maneuver->sequencer() : nullptr;
    const rig::bridge::Moment& moment = node_.step(sequencer,
                                                   {.number = maneuver != nullptr ? attempt_.number : 0,
                                                    .abort = maneuver != nullptr && !maneuver->record_error().empty(),
                                                    .reset = mistake_ != BridgeMistake::leaves_plc_tripped},
                                                   time());
    if (maneuver == nullptr) {
        begin();
    } else if (sequencer == nullptr) {
        if (maneuver->ready(moment)) begin_record();
    } else {
        (void)maneuver->follow(moment, moment.now + moment.bus.wall_minus_monotonic, *run_->samples);
        if (maneuver->over()) close();
    }
    return moment;
}

std::optional<std::int64_t> BridgeProgram::next_number() const {
    if (mistake_ != BridgeMistake::numbers_maneuvers_itself) return ledger_->next_number();
    return next_ <= campaign_.planned ? std::optional(next_) : std::nullopt;
}

void BridgeProgram::begin() {
    const auto product = machine_.gate.product();
    const auto number = next_number();
    complete_ = !number;
    if (complete_) return;
    attempt_ = ledger_->begin(*number, wall_text());
    outside_product([&] { audit_.begun(attempt_); });
    run_.emplace(Run{.request = {.plan = campaign_.plan,
                                 .campaign = kSimulatedCampaign,
                                 .number = attempt_.number,
                                 .folder = attempt_.folder,
                                 .specimen = ledger_->specimen(),
                                 .taken_J = ledger_->cumulative_energy_J(),
                                 .view = std::nullopt},
                     .maneuver = rig::bridge::ManeuverRun(campaign_.plan, node_.moment().rig_s)});
}

void BridgeProgram::begin_record() {
    const auto product = machine_.gate.product();
    const Time now = machine_.now();
    Run& run = *run_;
    run.started = wall_text();
    auto bus_log = std::make_unique<rig::record::AppendFile>(attempt_.folder / "bus.log", *machine_.disk);
    run.bus_log = bus_log.get();
    run.recording = std::make_unique<rig::bridge::Recording>(std::move(bus_log), setup_.options.interface, setup_.layout, setup_.meter, offset());
    auto modbus_csv = std::make_unique<rig::record::AppendFile>(attempt_.folder / "modbus.csv", *machine_.disk);
    run.modbus_csv = modbus_csv.get();
    run.samples = std::make_unique<rig::record::SampleLog>(std::move(modbus_csv));
    feed_.state.wall_minus_monotonic = run.recording->label.of(Time{});
    feed_.state.missing = 0;
    next_write_ = now + kWrite;
    next_sync_ = now + kSync;
    run.maneuver.begin();
}

void BridgeProgram::close() {
    const auto product = machine_.gate.product();
    Run& run = *run_;
    const bool late = mistake_ == BridgeMistake::enters_before_it_is_synced;
    if (late)
        run.recording->log.flush();
    else
        run.maneuver.finish(run.recording->log, *run.samples);
    const std::string lost = run.maneuver.record_error();
    if (lost.empty() && !late) outside_product([&] { audit_.synced(attempt_); });
    Summary summary = rig::bridge::summary_of(setup_, run.request, *run.maneuver.sequencer(), run.started, *run.recording, lost.empty());
    if (left_J_ != 0.0) {
        summary.figures.energy_brake_J += std::exchange(left_J_, 0.0);
        summary.cumulative_energy_J = run.request.taken_J + rig::record::counted_energy_J(summary);
    }
    enter(summary);
    if (late) run.maneuver.finish(run.recording->log, *run.samples);
    run_.reset();
    if (!lost.empty()) throw std::runtime_error("the record is not whole: " + lost);
    ++next_;
    begin();
}

void BridgeProgram::enter(const Summary& summary) {
    const double counted_J = rig::record::counted_energy_J(summary);
    outside_product([&] { audit_.of(attempt_).measured_J.insert(counted_J); });
    try {
        rig::bridge::enter(*ledger_, attempt_.folder, summary, *machine_.disk);
    } catch (const rig::record::LedgerInDoubt&) {
        throw;
    } catch (const rig::record::LedgerError&) {
        outside_product([&] { audit_.refused(attempt_); });
        if (mistake_ != BridgeMistake::ignores_no_memory) throw;
    } catch (const std::bad_alloc&) {
        if (mistake_ != BridgeMistake::ignores_no_memory) throw;
    }
    if (summary.outcome == rig::name(Phase::finished)) outside_product([&] { audit_.finished(attempt_, counted_J); });
}

}  // namespace plant_sim::simulation
