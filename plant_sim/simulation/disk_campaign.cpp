#include "plant_sim/simulation/disk_campaign.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "firmware/host/settings/file_descriptor.hpp"
#include "firmware/host/settings/input_file.hpp"
#include "rig_bridge/record/append_file.hpp"
#include "rig_bridge/record/bus_log.hpp"
#include "rig_bridge/record/ledger_database.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/replay/log_reader.hpp"
#include "rig_bridge/wear/draw.hpp"

namespace plant_sim::simulation {

using rig::record::Attempt;
using rig::record::LedgerRow;
using rig::record::RowState;
using rig::record::Summary;

namespace {

const std::filesystem::path kLedger = "/runs/brake7/campaign.sqlite";
constexpr const char* kName = "endurance";
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
    summary.campaign = kName;
    summary.number = attempt.number;
    summary.scenario = "heavy";
    summary.outcome = std::move(outcome);
    return summary;
}

/// A file in memory with a path: the log reader opens its logs by themselves.
class PassingFile {
  public:
    explicit PassingFile(std::string_view bytes) : file_(::memfd_create("bus.log", MFD_CLOEXEC)) {
        while (!bytes.empty()) {
            const ssize_t count = ::write(file_.get(), bytes.data(), bytes.size());
            if (count <= 0) throw std::system_error(errno, std::generic_category(), "a file in memory");
            bytes.remove_prefix(static_cast<std::size_t>(count));
        }
    }
    [[nodiscard]] std::string path() const { return fmt::format("/proc/self/fd/{}", file_.get()); }

  private:
    settings::FileDescriptor file_;
};

/// What the programs that ran have been told or have said.
struct Known {
    std::uint64_t frames = 0;    ///< recorded
    std::uint64_t synced = 0;    ///< of them on the disk, as the recorder was told
    bool begun = false;          ///< the ledger said so
    bool finished = false;       ///< said to be finished
    bool entry_refused = false;  ///< the ledger refused its finish with the power on
    std::set<std::uint64_t> offered_J;
};

class DiskCampaign {
  public:
    DiskCampaign(std::uint64_t seed, const Hands& hands, const DiskTrace& trace)
        : hands_(hands),
          trace_(trace),
          draw_(wear::generator_of(seed, 0)),
          planned_(static_cast<std::int64_t>(2 + below(4))),
          disk_(std::make_shared<SimulatedDisk>(seed, trace, hands.lapse)),
          storage_(hands.storage(disk_)) {}

    CampaignOutcome run() {
        const std::uint64_t failing = 1 + below(6);
        for (std::uint64_t start = 0; start < failing && !complete_; ++start) {
            strike();
            once();
        }
        disk_->calm();
        constexpr int kClean = 2;  // a refusal that the first one is still told of
        for (int i = 0; i < kClean && !complete_; ++i) once();
        if (!complete_) violated("the campaign does not come to its end though nothing fails any more");
        tell("power cut at rest");
        restart();
        check();
        out_.operations = disk_->operations();
        out_.struck = disk_->struck();
        return std::move(out_);
    }

  private:
    std::uint64_t below(std::uint64_t bound) { return draw_() % bound; }
    void tell(const std::string& line) const {
        if (trace_) trace_(line);
    }
    void violated(const std::string& what) {
        tell("VIOLATION: " + what);
        out_.violations.push_back(what);
    }
    [[nodiscard]] rig::record::LedgerOptions options() const { return {.durable = hands_.durable, .busy_timeout_ms = 0, .storage = storage_}; }

    void strike() {
        constexpr std::uint64_t kOperations = 60;  // of one maneuver, about
        const auto when = [this] { return 1 + below(kOperations * static_cast<std::uint64_t>(planned_)); };
        if (below(3) != 0) disk_->strike(when(), below(3) == 0 ? DiskFault::kill : DiskFault::power_cut);
        if (below(2) != 0) return;
        const auto fault = static_cast<DiskFault>(2 + below(3));
        disk_->strike(when(), fault, fault == DiskFault::no_space ? 1 + below(30) : 1);
    }

    /// The program, until it ends; and what it has left.
    void once() {
        ++out_.starts;
        tell(fmt::format("start {}", out_.starts));
        try {
            life();
        } catch (const std::runtime_error& error) {  // LedgerError, settings::Error, a recording that cannot be made
            tell(fmt::format("the program ends: {}", error.what()));
            if (disk_->runs()) ++out_.refusals;
        }
        if (!disk_->runs()) restart();
        disk_->calm();
        check();
    }

    void restart() {
        disk_->restart();
        tell("everything starts again");
    }

    void life() {
        rig::record::Ledger ledger(kLedger, options());
        const rig::record::Campaign campaign{
            .name = kName, .scenario = "heavy", .seed = 1, .planned = planned_, .config_hash = "c", .version = "v", .created = "2026"};
        (void)ledger.open_campaign(campaign, rig::record::IfChanged::reject, [this](const Attempt& left) { return meter(left); });
        while (const auto number = ledger.next_number()) {
            const Attempt attempt = ledger.begin(*number, "2026");
            Known& known = known_[attempt.folder.string()];
            known.begun = disk_->runs();
            ++out_.maneuvers;
            tell(fmt::format("maneuver {} begins, attempt {}", attempt.number, attempt.attempt));
            if (!maneuver(ledger, attempt, known)) return;
        }
        complete_ = true;
    }

    /// False: its record is not whole, and the program ends.
    bool maneuver(rig::record::Ledger& ledger, const Attempt& attempt, Known& known) {
        Summary summary = summary_of(attempt, "finished");
        const double taken_J = hands_.taken_J(ledger);
        const std::string lost = record(attempt, known);
        known.offered_J.insert(known.frames);
        summary.frames = known.frames;
        summary.figures.energy_brake_J = static_cast<double>(known.frames);
        summary.cumulative_energy_J = taken_J + summary.figures.energy_brake_J;
        if (!lost.empty() && !hands_.counts_lost) {
            tell("the record is lost: " + lost);
            summary.outcome = rig::record::kRecordLost;
            ledger.mark_unfinished(summary);
            return false;
        }
        rig::record::write_summary(attempt.folder / "summary.json", summary, *storage_);
        if (hands_.says_early) say_finished(attempt, known);
        try {
            ledger.finish(summary);
        } catch (const rig::record::LedgerInDoubt&) {
            throw;
        } catch (const rig::record::LedgerError&) {
            known.entry_refused = disk_->runs();
            throw;
        }
        say_finished(attempt, known);
        return true;
    }

    /// A dead program says nothing.
    void say_finished(const Attempt& attempt, Known& known) {
        if (!disk_->runs()) return;
        known.finished = true;
        tell(fmt::format("maneuver {} finished, {} J", attempt.number, known.frames));
    }

    /// Why the record is not whole; empty where it is.
    std::string record(const Attempt& attempt, Known& known) {
        auto file = std::make_unique<rig::record::AppendFile>(attempt.folder / "bus.log", *storage_);
        rig::record::AppendFile& lines = *file;
        rig::record::BusLog log(std::move(file), "can0");
        const std::uint64_t frames = 200 + below(4000);
        for (std::uint64_t i = 0; i < frames && disk_->runs(); ++i) {
            log.write({.frame = made_frame(attempt, i)});
            known.frames = i + 1;
            if (known.frames % kSynced_frames != 0) continue;
            lines.sync();
            if (disk_->runs() && log.error().empty()) known.synced = known.frames;
        }
        if (log.finish() && disk_->runs()) known.synced = known.frames;
        return log.error();
    }

    [[nodiscard]] ReadLog read(const Attempt& attempt, const settings::Storage& storage) const {
        constexpr std::size_t kLargest = 16U << 20U;
        const PassingFile file(settings::read_file(attempt.folder / "bus.log", kLargest, storage));
        rig::replay::LogWarnings warnings("bus.log", {});
        rig::replay::LogReader reader(file.path(), {}, warnings);
        ReadLog out;
        for (rig::replay::LogFrame frame; reader.next(frame); ++out.frames) {
            const antiskid::can::Frame made = made_frame(attempt, out.in_order);
            const bool same = frame.frame.data == made.data && frame.frame.length == made.length && frame.frame.received == made.received;
            if (out.in_order == out.frames && same) ++out.in_order;
        }
        out.damage_named = !warnings.damage().empty();
        return hands_.reading(out);
    }

    std::optional<Summary> meter(const Attempt& left) {
        if (!std::filesystem::exists(storage_->status(left.folder / "bus.log"))) return std::nullopt;
        const ReadLog log = read(left, *storage_);
        known_[left.folder.string()].offered_J.insert(log.frames);
        Summary summary = summary_of(left, "unfinished");
        summary.figures.energy_brake_J = static_cast<double>(log.frames);
        summary.frames = log.frames;
        return summary;
    }

    /// Everything that must hold, by the disk as it is now and nobody's storage in between.
    void check() {
        const bool said = std::any_of(known_.begin(), known_.end(), [](const auto& one) { return one.second.begun; });
        std::vector<LedgerRow> rows;
        try {
            const rig::record::LedgerOptions plain{.busy_timeout_ms = 0, .storage = disk_};
            if (std::filesystem::exists(disk_->status(kLedger)) || said) {
                const rig::record::LedgerDatabase database(kLedger, rig::record::LedgerDatabase::Access::read, plain);
                auto integrity = database.prepare("PRAGMA integrity_check");
                if (!integrity.step() || integrity.text(0) != "ok") violated("the ledger is damaged: " + integrity.text(0));
            }
            if (said) rows = rig::record::read_ledger(kLedger, kName, plain);
        } catch (const std::runtime_error& error) {
            if (said) violated(fmt::format("the ledger cannot be read: {}", error.what()));
            return;
        }
        check_rows(rows);
        for (auto& [folder, known] : known_) check_known(folder, known, rows);
    }

    void check_rows(const std::vector<LedgerRow>& rows) {
        std::set<std::int64_t> finished;
        double sum_J = 0.0;
        for (const LedgerRow& row : rows) {
            const std::string what = fmt::format("maneuver {}, attempt {}", row.attempt.number, row.attempt.attempt);
            if (row.state == RowState::finished && !finished.insert(row.attempt.number).second) violated(what + ": finished twice");
            if (row.has_figures) {
                sum_J += row.counted_J;
                if (row.summary.cumulative_energy_J != sum_J)
                    violated(fmt::format("{}: cumulative energy {} J, rows say {} J", what, row.summary.cumulative_energy_J, sum_J));
                if (!known_[row.attempt.folder.string()].offered_J.contains(static_cast<std::uint64_t>(row.counted_J)))
                    violated(fmt::format("{}: {} J that nobody measured", what, row.counted_J));
            }
            check_folder(row, what);
        }
    }

    void check_folder(const LedgerRow& row, const std::string& what) {
        const bool counts = row.state == RowState::finished;
        Known& known = known_[row.attempt.folder.string()];
        if (std::filesystem::exists(disk_->status(row.attempt.folder / "summary.json"))) {
            try {
                const Summary summary = rig::record::read_summary(row.attempt.folder / "summary.json", *disk_);
                if (summary.number != row.attempt.number || summary.frames != known.frames) violated(what + ": its summary.json is another's");
            } catch (const settings::Error& error) {
                violated(fmt::format("{}: half written under its final name: {}", what, error.what()));
            }
        } else if (counts) {
            violated(what + ": finished, and there is no summary.json");
        }
        if (!std::filesystem::exists(disk_->status(row.attempt.folder / "bus.log"))) {
            if (known.synced > 0) violated(what + ": the recording is gone");
            return;
        }
        const ReadLog log = read(row.attempt, *disk_);
        if (log.damage_named) ++out_.damaged;
        if (log.in_order < known.synced) violated(fmt::format("{}: {} frames were on the disk, {} are left", what, known.synced, log.in_order));
        if (log.frames != log.in_order && !log.damage_named) violated(fmt::format("{}: damage in its recording that nobody names", what));
        if (counts && (log.in_order != known.frames || log.damage_named)) violated(what + ": finished, and its recording is not whole");
    }

    void check_known(const std::string& folder, Known& known, const std::vector<LedgerRow>& rows) {
        const auto row = std::find_if(rows.begin(), rows.end(), [&](const LedgerRow& one) { return one.attempt.folder == folder; });
        if (row == rows.end()) {
            if (known.begun) violated(folder + ": begun, and the ledger knows nothing of it");
            return;
        }
        // The next start may adopt it by its summary.json.
        if (std::exchange(known.entry_refused, false) && row->state == RowState::finished) violated(folder + ": refused by the ledger, and entered");
        if (known.finished && row->state != RowState::finished) violated(folder + ": said to be finished, and the ledger does not say so");
        if (known.finished && row->counted_J != static_cast<double>(known.frames)) violated(folder + ": its energy is another one");
    }

    const Hands& hands_;
    const DiskTrace& trace_;
    wear::Generator draw_;
    std::int64_t planned_;
    std::shared_ptr<const SimulatedDisk> disk_;
    std::shared_ptr<const settings::Storage> storage_;
    std::map<std::string, Known> known_;  // by folder
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
    for (std::size_t i = 0; i < struck.size(); ++i) struck.at(i) += other.struck.at(i);
    return *this;
}

CampaignOutcome run_disk_campaign(std::uint64_t seed, const Hands& hands, const DiskTrace& trace) {
    return DiskCampaign(seed, hands, trace).run();
}

}  // namespace plant_sim::simulation
