/// Loads a campaign's wear data from a CSV, a ledger, or a directory with a ledger.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/wear/wear_campaign.hpp"

namespace rig::replay {

/// Treatment of maneuvers that finished out of tolerance. If left out, they still count in the cumulative energy.
enum class OutOfTolerance : std::uint8_t { left_out, taken };

/// `where` itself, or campaign.sqlite in that directory.
[[nodiscard]] std::filesystem::path ledger_at(const std::filesystem::path& where);

/// `wanted`, or if empty the ledger's only campaign. Throws settings::Error if there is none or several, or the file is not a ledger.
[[nodiscard]] std::string chosen_campaign(const std::filesystem::path& ledger, const std::string& wanted);

/// Of a campaign's rows, oldest first: every maneuver finished within tolerance is a point, unless its energies do not balance and nobody amended
/// them, or it adds no energy; one out of tolerance is a landing all the same. Aborted ones count in the cumulative energy, also after the newest
/// point, and what was read of the lining after any of them is a reading. If brake or disc were changed, only the newest pair is used, with its own
/// energy. `source` is what was left out, for people.
[[nodiscard]] wear::Campaign wear_of(const std::vector<record::LedgerRow>& rows, OutOfTolerance off = OutOfTolerance::left_out);

/// `where`: an SQLite ledger or a directory with campaign.sqlite in it (of `campaign`, which may be empty when the ledger holds one only), else
/// a CSV as wear::read_campaign() takes it. From a ledger as wear_of() says; in messages, row i is then the i-th finished maneuver. Throws
/// settings::Error as wear::read_campaign() and read_ledger() do.
[[nodiscard]] wear::Campaign load_campaign(const std::filesystem::path& where, const std::string& campaign,
                                           OutOfTolerance off = OutOfTolerance::left_out);

/// Several: each source is a campaign as above (of a ledger with one), or a directory without a ledger, of which every *.csv is a campaign,
/// by name. Throws settings::Error where there is none.
[[nodiscard]] std::vector<wear::Campaign> load_campaigns(const std::vector<std::filesystem::path>& sources,
                                                         OutOfTolerance off = OutOfTolerance::left_out);

}  // namespace rig::replay
