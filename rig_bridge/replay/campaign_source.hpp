/// A campaign's wear from whatever holds it: a CSV, the bridge's ledger, or the directory of a ledger.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "rig_bridge/wear/wear_campaign.hpp"

namespace rig::replay {

/// What becomes of maneuvers that finished outside their scenario's bands. Left out, they are still in the cumulative energy.
enum class OutOfTolerance : std::uint8_t { left_out, taken };

/// `where`, or the campaign.sqlite of that directory.
[[nodiscard]] std::filesystem::path ledger_at(const std::filesystem::path& where);

/// `wanted`, or where that is empty the ledger's only campaign. Throws settings::Error where there is none or there are several,
/// and in any case where the file is no ledger.
[[nodiscard]] std::string chosen_campaign(const std::filesystem::path& ledger, const std::string& wanted);

/// `where`: an SQLite ledger or a directory with campaign.sqlite in it (of `campaign`, which may be empty when the ledger holds one only), else
/// a CSV as wear::read_campaign() takes it. From a ledger every maneuver that finished, within tolerance, is a point; what the aborted ones took is
/// in the cumulative energy. Where brake or disc were changed, of the newest alone, with the energy that those took. Row i in messages is then the
/// i-th finished one. Throws settings::Error as wear::read_campaign() and read_ledger() do.
[[nodiscard]] wear::Campaign load_campaign(const std::filesystem::path& where, const std::string& campaign,
                                           OutOfTolerance off = OutOfTolerance::left_out);

/// Several: each source is a campaign as above (of a ledger with one), or a directory without a ledger, of which every *.csv is a campaign,
/// by name. Throws settings::Error where there is none.
[[nodiscard]] std::vector<wear::Campaign> load_campaigns(const std::vector<std::filesystem::path>& sources,
                                                         OutOfTolerance off = OutOfTolerance::left_out);

}  // namespace rig::replay
