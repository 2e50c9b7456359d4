#include "plant_sim/simulation/disk_campaign.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "rig_bridge/record/append_file.hpp"
#include "rig_bridge/record/bus_log.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/wear/draw.hpp"

namespace plant_sim::simulation {

using rig::record::Attempt;
using rig::record::Summary;

namespace {

constexpr std::int64_t kFrame_ns = 1'000'000;
constexpr std::int64_t kEpoch_ns = 1'764'000'000'000'000'000;
constexpr std::uint64_t kSynced_frames = 1000;  // LiveFile syncs each second

antiskid::can::Frame made_frame(const Attempt& attempt, std::uint64_t index) {
    antiskid::can::Frame frame{.id = 0x100, .length = 8};
    frame.data[0] = static_cast<std::uint8_t>(attempt.number);
    frame.data[1] = static_cast<std::uint8_t>(attempt.attempt);
    for (std::size_t i = 0; i < 4; ++i) frame.data.at(4 + i) = static_cast<std::uint8_t>(index >> (8 * i));
    frame.received = antiskid::can::Time(kEpoch_ns + static_cast<std::int64_t>(index) * kFrame_ns);
    return frame;
}

Summary summary_of(const Attempt& attempt, std::string outcome) {
    Summary summary;
    summary.campaign = kSimulatedCampaign;
    summary.number = attempt.number;
    summary.scenario = "heavy";
    summary.outcome = std::move(outcome);
    return summary;
}

class DiskCampaign {
  public:
    DiskCampaign(std::uint64_t seed, const DiskCampaignSetup& setup, const DiskTrace& trace)
        : setup_(setup),
          trace_(trace),
          draw_(wear::generator_of(seed, 0)),
          planned_(static_cast<std::int64_t>(2 + below(4))),
          disk_(std::make_shared<SimulatedDisk>(seed, trace, setup.deviation)),
          storage_(setup.storage(disk_)),
          audit_(disk_, setup.reading) {}

    CampaignOutcome run() {
        const std::uint64_t failing = 1 + below(6);
        for (std::uint64_t start = 0; start < failing && !complete_; ++start) {
            inject();
            once();
        }
        disk_->clear_faults();
        constexpr int kClean = 2;  // an earlier refusal may still be reported to the first one
        for (int i = 0; i < kClean && !complete_; ++i) once();
        if (!complete_) violated("the campaign does not come to its end though nothing fails any more");
        trace_line("power cut at rest");
        restart();
        check();
        out_.operations = disk_->operations();
        out_.fault_counts = disk_->fault_counts();
        out_.damaged = audit_.damaged();
        return std::move(out_);
    }

  private:
    std::uint64_t below(std::uint64_t bound) { return draw_() % bound; }
    void trace_line(const std::string& line) const {
        if (trace_) trace_(line);
    }
    void violated(const std::string& what) {
        trace_line("VIOLATION: " + what);
        out_.violations.push_back(what);
    }
    [[nodiscard]] rig::record::LedgerOptions options() const { return {.durable = setup_.durable, .busy_timeout_ms = 0, .storage = storage_}; }

    void inject() {
        constexpr std::uint64_t kOperations = 60;  // of one maneuver, about
        const auto when = [this] { return 1 + below(kOperations * static_cast<std::uint64_t>(planned_)); };
        if (below(3) != 0) disk_->inject(when(), below(3) == 0 ? DiskFault::kill : DiskFault::power_cut);
        if (below(2) != 0) return;
        const auto fault = static_cast<DiskFault>(2 + below(3));
        disk_->inject(when(), fault, fault == DiskFault::no_space ? 1 + below(30) : 1);
    }

    /// One run of the program, and the check of what it left.
    void once() {
        ++out_.starts;
        trace_line(fmt::format("start {}", out_.starts));
        try {
            life();
        } catch (const std::runtime_error& error) {  // LedgerError, settings::Error, a recording that cannot be made
            trace_line(fmt::format("the program ends: {}", error.what()));
            if (disk_->runs()) ++out_.refusals;
        }
        if (!disk_->runs()) restart();
        disk_->clear_faults();
        check();
    }

    void restart() {
        disk_->restart();
        trace_line("everything starts again");
    }

    void life() {
        rig::record::Ledger ledger(kSimulatedLedger, options());
        const rig::record::Campaign campaign{
            .name = kSimulatedCampaign, .scenario = "heavy", .seed = 1, .planned = planned_, .config_hash = "c", .version = "v", .created = "2026"};
        (void)ledger.open_campaign(campaign, rig::record::IfChanged::reject, [this](const Attempt& left) { return meter(left); });
        while (const auto number = ledger.next_number()) {
            const Attempt attempt = ledger.begin(*number, "2026");
            audit_.begun(attempt);
            ++out_.maneuvers;
            trace_line(fmt::format("maneuver {} begins, attempt {}", attempt.number, attempt.attempt));
            if (!maneuver(ledger, attempt)) return;
        }
        complete_ = true;
    }

    /// False: the record is incomplete, and the program ends.
    bool maneuver(rig::record::Ledger& ledger, const Attempt& attempt) {
        Summary summary = summary_of(attempt, "finished");
        const double taken_J = setup_.taken_J(ledger);
        const std::string lost = record(attempt);
        summary.frames = audit_.of(attempt).frames.size();
        summary.figures.energy_brake_J = static_cast<double>(summary.frames);
        audit_.of(attempt).measured_J.insert(summary.figures.energy_brake_J);
        summary.cumulative_energy_J = taken_J + summary.figures.energy_brake_J;
        if (!lost.empty() && !setup_.counts_lost) {
            trace_line("the record is lost: " + lost);
            summary.outcome = rig::record::kRecordLost;
            ledger.mark_unfinished(summary);
            return false;
        }
        rig::record::write_summary(attempt.folder / "summary.json", summary, *storage_);
        if (setup_.says_early) say_finished(attempt, summary);
        try {
            ledger.finish(summary);
        } catch (const rig::record::LedgerInDoubt&) {
            throw;
        } catch (const rig::record::LedgerError&) {
            audit_.refused(attempt);
            throw;
        }
        say_finished(attempt, summary);
        return true;
    }

    /// A dead program reports nothing.
    void say_finished(const Attempt& attempt, const Summary& summary) {
        audit_.finished(attempt, summary.figures.energy_brake_J);
        if (disk_->runs()) trace_line(fmt::format("maneuver {} finished, {} J", attempt.number, summary.frames));
    }

    /// Reason why the record is incomplete; empty: it is complete.
    std::string record(const Attempt& attempt) {
        CampaignAudit::Known& known = audit_.of(attempt);
        auto file = std::make_unique<rig::record::AppendFile>(attempt.folder / "bus.log", *storage_);
        rig::record::AppendFile& lines = *file;
        rig::record::BusLog log(std::move(file), "can0");
        const std::uint64_t frames = 200 + below(4000);
        for (std::uint64_t i = 0; i < frames && disk_->runs(); ++i) {
            log.write({.frame = made_frame(attempt, i)});
            known.frames.push_back(made_frame(attempt, i));
            if (known.frames.size() % kSynced_frames != 0) continue;
            lines.sync();
            if (log.error().empty()) audit_.synced(attempt);
        }
        if (log.finish()) audit_.synced(attempt);
        return log.error();
    }

    std::optional<Summary> meter(const Attempt& left) {
        if (!std::filesystem::exists(storage_->status(left.folder / "bus.log"))) return std::nullopt;
        const ReadLog log = audit_.read(left);
        Summary summary = summary_of(left, "unfinished");
        summary.figures.energy_brake_J = static_cast<double>(log.frames);
        summary.frames = log.frames;
        audit_.of(left).measured_J.insert(summary.figures.energy_brake_J);
        return summary;
    }

    void check() {
        for (const std::string& violation : audit_.check()) violated(violation);
    }

    const DiskCampaignSetup& setup_;
    const DiskTrace& trace_;
    wear::Generator draw_;
    std::int64_t planned_;
    std::shared_ptr<const SimulatedDisk> disk_;
    std::shared_ptr<const settings::Storage> storage_;
    CampaignAudit audit_;
    CampaignOutcome out_;
    bool complete_ = false;
};

}  // namespace

CampaignOutcome& CampaignOutcome::operator+=(const CampaignOutcome& other) {
    violations.insert(violations.end(), other.violations.begin(), other.violations.end());
    maneuvers += other.maneuvers;
    starts += other.starts;
    operations += other.operations;
    damaged += other.damaged;
    refusals += other.refusals;
    for (std::size_t i = 0; i < fault_counts.size(); ++i) fault_counts.at(i) += other.fault_counts.at(i);
    return *this;
}

CampaignOutcome run_disk_campaign(std::uint64_t seed, const DiskCampaignSetup& setup, const DiskTrace& trace) {
    return DiskCampaign(seed, setup, trace).run();
}

}  // namespace plant_sim::simulation
