/// Rebuilds a campaign (Fig. 7: mean friction over cumulative brake energy) from the raw logs, and compares it with summaries and ledger.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/can/layout.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/record/meter.hpp"
#include "rig_bridge/replay/log_reader.hpp"

namespace rig::replay {

/// The folders NNNN and NNNN.A of `campaign`, by number and attempt. Throws std::runtime_error when there is none, or two for the
/// same attempt (1 and 0001).
[[nodiscard]] std::vector<record::Attempt> maneuver_folders(const std::filesystem::path& campaign);

/// Warning of a row with known figures whose log is lost: they are those of summary.json or of the ledger.
inline constexpr std::string_view kLogMissing = "log_missing";

struct CampaignRow {
    record::Attempt attempt;
    bool counted = false;  ///< has figures, and its energy counts
    bool ended = false;    ///< finished or aborted, by a summary.json or by the ledger
    /// summary.json, or the ledger's without it. Figures and warnings from the log if there is one; sums from all rows, as amended.
    record::Summary summary;
    record::Specimen specimen{};  ///< as noted; `summary` has it as it was recorded
    record::WearReading worn{};   ///< as noted
    double disc_energy_J = 0.0;   ///< part of the cumulative energy taken by this row's brake and disc
    /// "mean_friction is 0.29817 from the log, 0.29816 in summary.json"; bit by bit.
    std::vector<std::string> differences;
};

struct CampaignTable {
    std::vector<CampaignRow> rows;
    bool with_ledger = false;
    std::uint64_t lines = 0;
    [[nodiscard]] std::uint64_t counted() const;
    [[nodiscard]] std::uint64_t different() const;  ///< rows
};

struct CampaignSources {
    const antiskid::can::Layout& layout;
    /// Meter parameters of the scenario with this name in the summary.
    std::function<record::MeterParameters(const std::string& scenario)> parameters;
    std::vector<record::LedgerRow> ledger;  ///< of this campaign; empty with `with_ledger` false
    bool with_ledger = false;
    std::function<LogWarnings(const std::string& file)> warnings;
};

/// Writes the campaign to a new ledger beside the folders, with amendments and notes of `old`. Atomic: in FILE.part until it is whole. Throws
/// settings::Error if `file` exists or cannot be stored, and LedgerError; it is then not there, or whole if only the sync of its directory failed.
void write_ledger(const std::filesystem::path& file, const record::Campaign& campaign, const CampaignTable& table,
                  const std::vector<record::LedgerRow>& old);

/// Reads every log of the folders; rows by number and attempt, those of the ledger without a folder among them. A missing log or folder counts as a
/// difference, and what is known without it stays, with kLogMissing. Amendments in the ledger are applied.
[[nodiscard]] CampaignTable rebuild_campaign(const std::vector<record::Attempt>& folders, const CampaignSources& sources);

[[nodiscard]] std::string to_text(const CampaignTable& table);
/// number,attempt,outcome,cumulative_energy_J, every figure, the specimen's fields and disc_energy_J by their keys.
[[nodiscard]] std::string to_csv(const CampaignTable& table);
[[nodiscard]] std::string to_json(const CampaignTable& table, const std::string& campaign);

}  // namespace rig::replay
