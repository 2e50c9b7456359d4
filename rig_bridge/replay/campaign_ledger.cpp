// write_ledger() of campaign_table.hpp.
#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <system_error>

#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/storage.hpp"
#include "rig_bridge/replay/campaign_table.hpp"

namespace rig::replay {

namespace {

namespace fs = std::filesystem;

/// A ledger that gets its name when it is whole: half of one would be taken for the campaign.
class PartLedger {
  public:
    explicit PartLedger(const fs::path& file) : file_(file), part_(file.string() + ".part") {
        if (record::is_held(part_)) throw settings::Error(file_.string(), 0, "", "is being rebuilt by another program");
        clear();
    }
    ~PartLedger() { clear(); }
    PartLedger(const PartLedger&) = delete;
    PartLedger& operator=(const PartLedger&) = delete;

    [[nodiscard]] const fs::path& path() const { return part_; }

    /// No ledger may be open in it.
    void commit() const {
        const settings::PosixStorage storage;
        settings::OpenResult opened = storage.open(part_);
        int error = opened.error != 0 ? opened.error : opened.file->sync();
        if (error == 0) error = storage.rename(part_, file_);
        if (error == 0) error = storage.sync_directory(fs::absolute(file_).parent_path());
        if (error != 0) throw settings::Error(file_.string(), 0, "", std::string("cannot be stored: ") + std::strerror(error));
    }

  private:
    /// The ledger with SQLite's journal and the lock beside it.
    void clear() const {
        for (const char* const end : {"", "-journal", "-wal", "-shm", "-held"}) {
            std::error_code ignored;
            fs::remove(part_.string() + end, ignored);
        }
    }
    fs::path file_, part_;
};

void enter(record::Ledger& ledger, const std::string& campaign, const CampaignRow& row, const record::LedgerRow* old) {
    std::optional<double> slip_reference;
    if (old != nullptr) slip_reference = old->slip_reference;
    // An attempt without a folder never had one, or lost it: nothing is known of it.
    while (ledger.begin(row.attempt.number, row.summary.started, slip_reference, row.summary.specimen).attempt < row.attempt.attempt)
        ledger.mark_unfinished();
    if (!row.ended) {
        ledger.mark_unfinished(row.counted ? std::optional(row.summary) : std::nullopt);
        return;
    }
    record::Summary summary = row.summary;
    summary.campaign = campaign;
    summary.cumulative_energy_J = ledger.cumulative_energy_J() + record::counted_energy_J(summary);
    ledger.finish(summary);
    if (old != nullptr && !old->health.model.empty() && old->state == record::RowState::finished) ledger.judge(row.attempt.number, old->health);
}

void fill(const fs::path& file, const record::Campaign& campaign, const CampaignTable& table, const std::vector<record::LedgerRow>& old) {
    record::LedgerOptions options;
    options.durable = false;  // it is stored once, when it is whole
    record::Ledger ledger(file, options);
    ledger.open_campaign(campaign, record::IfChanged::reject);
    for (const CampaignRow& row : table.rows)
        if (const record::LedgerRow* was = row_of(old, row.attempt); row.ended || row.counted || was != nullptr)
            enter(ledger, campaign.name, row, was);
    for (const record::LedgerRow& row : old)
        for (const record::Amendment& amendment : row.amendments) ledger.amend(row.attempt.number, row.attempt.attempt, amendment);
    for (const record::LedgerRow& row : old)
        for (const record::Note& note : row.notes) ledger.note(row.attempt.number, row.attempt.attempt, note);
}

}  // namespace

void write_ledger(const std::filesystem::path& file, const record::Campaign& campaign, const CampaignTable& table,
                  const std::vector<record::LedgerRow>& old) {
    if (std::filesystem::exists(file)) throw settings::Error(file.string(), 0, "", "is there already; a rebuilt ledger is a new file");
    const PartLedger part(file);
    fill(part.path(), campaign, table, old);
    part.commit();
}

}  // namespace rig::replay
