#include "plant_sim/simulation/campaign_audit.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "firmware/host/settings/error.hpp"
#include "rig_bridge/record/ledger_database.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/replay/log_reader.hpp"

namespace plant_sim::simulation {

using antiskid::can::Frame;
using rig::record::Attempt;
using rig::record::LedgerRow;
using rig::record::RowState;

namespace {

/// Times in a log are in microseconds.
bool same(const Frame& a, const Frame& b) {
    return a.id == b.id && a.length == b.length && a.data == b.data && a.received.count() / 1000 == b.received.count() / 1000;
}

}  // namespace

MemoryFile::MemoryFile(std::string_view bytes) : file_(::memfd_create("bus.log", MFD_CLOEXEC)) {
    while (!bytes.empty()) {
        const ssize_t count = ::write(file_.get(), bytes.data(), bytes.size());
        if (count <= 0) throw std::system_error(errno, std::generic_category(), "a file in memory");
        bytes.remove_prefix(static_cast<std::size_t>(count));
    }
}

std::string MemoryFile::path() const {
    return fmt::format("/proc/self/fd/{}", file_.get());
}

CampaignAudit::CampaignAudit(std::shared_ptr<const SimulatedDisk> disk, Reading reading) : disk_(std::move(disk)), reading_(std::move(reading)) {}

void CampaignAudit::synced(const Attempt& attempt) {
    Known& known = of(attempt);
    if (disk_->runs()) known.synced = known.frames.size();
}

void CampaignAudit::finished(const Attempt& attempt, double counted_J) {
    if (!disk_->runs()) return;
    Known& known = of(attempt);
    known.finished = true;
    known.finished_J = counted_J;
}

ReadLog CampaignAudit::read(const Attempt& attempt) {
    Known& known = of(attempt);
    const std::filesystem::path path = attempt.folder / "bus.log";
    const std::uint64_t version = disk_->version(path);
    if (version == known.log_version) return known.log;
    rig::replay::LogWarnings warnings("bus.log", {});
    rig::replay::LogReader reader(rig::replay::LogText{disk_->bytes(path)}, {}, warnings);
    ReadLog log;
    for (rig::replay::LogFrame frame; reader.next(frame); ++log.frames)
        if (log.in_order == log.frames && log.in_order < known.frames.size() && same(frame.frame, known.frames[log.in_order])) ++log.in_order;
    log.steps_back = warnings.count(rig::replay::LogTrouble::time_backwards);
    log.damage_named = !warnings.damage().empty();
    known.log = reading_ ? reading_(log) : log;
    known.log_version = version;
    return known.log;
}

std::vector<std::string> CampaignAudit::check() {
    violations_.clear();
    rows_.clear();
    if (read_rows()) {
        check_rows();
        for (auto& [folder, known] : known_) check_known(folder, known);
    }
    return std::exchange(violations_, {});
}

bool CampaignAudit::read_rows() {
    const bool said = std::any_of(known_.begin(), known_.end(), [](const auto& one) { return one.second.begun; });
    try {
        const rig::record::LedgerOptions plain{.busy_timeout_ms = 0, .storage = disk_};
        if (std::filesystem::exists(disk_->status(kSimulatedLedger)) || said) {
            const rig::record::LedgerDatabase database(kSimulatedLedger, rig::record::LedgerDatabase::Access::read, plain);
            auto integrity = database.prepare("PRAGMA integrity_check");
            if (!integrity.step() || integrity.text(0) != "ok") violated("the ledger is damaged: " + integrity.text(0));
        }
        if (said) rows_ = rig::record::read_ledger(kSimulatedLedger, kSimulatedCampaign, plain);
        return true;
    } catch (const std::runtime_error& error) {
        if (said) violated(fmt::format("the ledger cannot be read: {}", error.what()));
        return false;
    }
}

void CampaignAudit::check_rows() {
    std::set<std::int64_t> finished;
    double sum_J = 0.0;
    for (const LedgerRow& row : rows_) {
        const std::string what = fmt::format("maneuver {}, attempt {}", row.attempt.number, row.attempt.attempt);
        if (row.state == RowState::finished && !finished.insert(row.attempt.number).second) violated(what + ": finished twice");
        if (row.has_figures) {
            sum_J += row.counted_J;
            if (row.summary.cumulative_energy_J != sum_J)
                violated(fmt::format("{}: cumulative energy {} J, rows say {} J", what, row.summary.cumulative_energy_J, sum_J));
            if (!of(row.attempt).measured_J.contains(row.counted_J)) violated(fmt::format("{}: {} J that nobody measured", what, row.counted_J));
        }
        check_folder(row, what);
    }
}

void CampaignAudit::check_folder(const LedgerRow& row, const std::string& what) {
    const bool counts = row.state == RowState::finished;
    const Known& known = of(row.attempt);
    if (std::filesystem::exists(disk_->status(row.attempt.folder / "summary.json"))) {
        try {
            const rig::record::Summary summary = rig::record::read_summary(row.attempt.folder / "summary.json", *disk_);
            if (summary.number != row.attempt.number || summary.frames != known.frames.size()) violated(what + ": its summary.json is another's");
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
    const ReadLog log = read(row.attempt);
    if (log.damage_named) ++damaged_;
    if (log.in_order < known.synced) violated(fmt::format("{}: {} frames were on the disk, {} are left", what, known.synced, log.in_order));
    if (log.frames != log.in_order && !log.damage_named) violated(fmt::format("{}: damage in its recording that nobody names", what));
    if (counts && (log.in_order != known.frames.size() || log.damage_named)) violated(what + ": finished, and its recording is not whole");
    if (log.steps_back != 0 && !log.damage_named) violated(fmt::format("{}: the time stamps of its recording go back", what));
}

void CampaignAudit::check_known(const std::string& folder, Known& known) {
    const auto row = std::find_if(rows_.begin(), rows_.end(), [&](const LedgerRow& one) { return one.attempt.folder == folder; });
    if (row == rows_.end()) {
        if (known.begun) violated(folder + ": begun, and the ledger knows nothing of it");
        return;
    }
    // The next start may enter the maneuver by its summary.json.
    if (std::exchange(known.entry_refused, false) && row->state == RowState::finished) violated(folder + ": refused by the ledger, and entered");
    if (known.finished && row->state != RowState::finished) violated(folder + ": said to be finished, and the ledger does not say so");
    if (known.finished && row->counted_J != known.finished_J) violated(folder + ": its energy is another one");
}

}  // namespace plant_sim::simulation
