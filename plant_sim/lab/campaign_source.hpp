/// A campaign from whatever holds it: a CSV, the bridge's ledger, or the directory of a ledger.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "firmware/host/settings/command_line.hpp"
#include "rig_bridge/wear/population_io.hpp"
#include "rig_bridge/wear/wear_campaign.hpp"

namespace plant_sim::lab {

/// What becomes of maneuvers that finished outside their scenario's bands. Left out, they are still in the cumulative energy.
enum class OutOfTolerance : std::uint8_t { left_out, taken };

/// `where`: an SQLite ledger or a directory with campaign.sqlite in it (of `campaign`, which may be empty when the ledger holds one only), else
/// a CSV as wear::read_campaign() takes it. From a ledger every maneuver that finished, within tolerance, is a point; what the aborted ones took is
/// in the cumulative energy. Where brake or disc were changed, of the newest alone, with the energy that those took. Row i in messages is then the
/// i-th finished one. Throws settings::Error as wear::read_campaign() and rig::record::read_ledger() do.
[[nodiscard]] wear::Campaign load_campaign(const std::filesystem::path& where, const std::string& campaign,
                                           OutOfTolerance off = OutOfTolerance::left_out);

/// Several: each source is a campaign as above (of a ledger with one), or a directory without a ledger, of which every *.csv is a campaign,
/// by name. Throws settings::Error where there is none.
[[nodiscard]] std::vector<wear::Campaign> load_campaigns(const std::vector<std::filesystem::path>& sources,
                                                         OutOfTolerance off = OutOfTolerance::left_out);

/// --model and --assume-made-up of a verb that judges a brake by others.
struct PopulationOptions {
    std::filesystem::path model;  ///< empty: the shipped one, which is made up, and only when that is asked for
    bool assume_made_up = false;

    void add_to(CLI::App& verb);
    /// Throws std::invalid_argument when neither is given, settings::Error for a file that is none.
    [[nodiscard]] wear::PopulationFile read() const;
};

/// --origin of a verb that learns: what its campaigns say of themselves, unless it is given.
void add_origin(CLI::App& verb, std::string& origin);

/// --out-of-tolerance of a verb that reads campaigns.
void add_out_of_tolerance_flag(CLI::App& verb, OutOfTolerance& off);

}  // namespace plant_sim::lab
