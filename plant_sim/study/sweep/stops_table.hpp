/// Tables of stops as CSV: a first line that identifies the sweep, a line with the columns' names and units, one line per stop.
///
///     # antiskid sweep 1 {"version":"0.1.0","config_hash":"...","seed":1,"references":[0.06,...],"landings":100,...}
///     stop,law,slip_reference,landing,surface,maneuver,c_e_J,mean_friction,sensor_seed,standstill,faults,j_mu,stop_distance_m,...
///
/// Numbers are written with all their bits.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/host/settings/error.hpp"
#include "plant_sim/study/sweep/run.hpp"

namespace sweep {

/// Properties that the stops of one sweep have in common.
struct Identity {
    std::string version;
    std::string config_hash;
    std::uint64_t seed = 0;
    std::vector<double> references{};
    std::size_t landings = 0;
    bool threshold = false;
    bool operator==(const Identity&) const = default;

    [[nodiscard]] std::size_t stops() const { return (references.size() + (threshold ? 1 : 0)) * landings; }
};

[[nodiscard]] Identity identity_of(const SweepPlan& plan);
/// Text of the first difference, "seed 2 instead of 1"; empty if there is none.
[[nodiscard]] std::string difference(const Identity& got, const Identity& wanted);

struct StopsTable {
    std::string name;  ///< name of the file, for messages
    Identity identity{};
    std::vector<SweptStop> rows{};
    std::size_t whole = 0;  ///< number of bytes up to the end of the last complete line
};

/// The first two lines.
[[nodiscard]] std::string head(const Identity& identity);
/// One stop as a line, with its end.
[[nodiscard]] std::string line(const SweptStop& row);
[[nodiscard]] std::string to_csv(const Identity& identity, std::span<const SweptStop> rows);

/// Throws settings::Error with `name` and line for another kind or version of table, or a damaged one, or if a stop is in it twice. A last line
/// without an end, as a killed program leaves it, is ignored.
[[nodiscard]] StopsTable parse_stops(const std::string& name, std::string_view csv);
[[nodiscard]] StopsTable read_stops(const std::filesystem::path& csv);
/// Parses a line of line() without its end.
[[nodiscard]] SweptStop parse_row(const std::string& name, std::uint32_t line_number, std::string_view text);

}  // namespace sweep
