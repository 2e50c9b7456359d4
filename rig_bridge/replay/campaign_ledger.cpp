#include <algorithm>

#include "firmware/host/settings/error.hpp"
#include "rig_bridge/replay/campaign_table.hpp"

namespace rig::replay {

namespace {

const record::LedgerRow* row_of(const std::vector<record::LedgerRow>& rows, const ManeuverFolder& folder) {
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const record::LedgerRow& row) {
        return row.attempt.number == folder.number && row.attempt.attempt == folder.attempt;
    });
    return found == rows.end() ? nullptr : &*found;
}

void enter(record::Ledger& ledger, const std::string& campaign, const CampaignRow& row, const record::LedgerRow* old) {
    std::optional<double> slip_reference;
    if (old != nullptr) slip_reference = old->slip_reference;
    // An attempt without a folder had none to begin with, or lost it: nothing is known of it.
    while (ledger.begin(row.folder.number, row.summary.started, slip_reference, row.summary.specimen).attempt < row.folder.attempt)
        ledger.mark_unfinished();
    if (!row.ended) {
        ledger.mark_unfinished(row.counted ? std::optional(row.summary) : std::nullopt);
        return;
    }
    record::Summary summary = row.summary;
    summary.campaign = campaign;
    summary.cumulative_energy_J = ledger.cumulative_energy_J() + record::counted_energy_J(summary);
    ledger.finish(summary);
    if (old != nullptr && !old->health.model.empty() && old->state == record::RowState::finished) ledger.judge(row.folder.number, old->health);
}

}  // namespace

void write_ledger(const std::filesystem::path& file, const record::Campaign& campaign, const CampaignTable& table,
                  const std::vector<record::LedgerRow>& old) {
    if (std::filesystem::exists(file)) throw settings::Error(file.string(), 0, "", "is there already; a rebuilt ledger is a new file");
    record::Ledger ledger(file);
    ledger.open_campaign(campaign, record::IfChanged::reject);
    for (const CampaignRow& row : table.rows)
        if (const record::LedgerRow* was = row_of(old, row.folder); row.ended || row.counted || was != nullptr)
            enter(ledger, campaign.name, row, was);
    for (const record::LedgerRow& row : old)
        for (const record::Amendment& amendment : row.amendments) ledger.amend(row.attempt.number, row.attempt.attempt, amendment);
    for (const record::LedgerRow& row : old)
        for (const record::Note& note : row.notes) ledger.note(row.attempt.number, row.attempt.attempt, note);
}

}  // namespace rig::replay
