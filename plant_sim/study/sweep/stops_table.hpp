/// Tables of stops as CSV: a first line that says what sweep they belong to, the names of the columns with their units, one line a
/// stop.
///
///     # antiskid sweep 1 {"version":"0.1.0","config_hash":"...","seed":1,"references":[0.06,...],"landings":100,...}
///     stop,law,slip_reference,landing,surface,maneuver,c_e_J,mean_friction,sensor_seed,standstill,faults,j_mu,stop_distance_m,...
///
/// Numbers are written so that they read back to the last bit.
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

/// What has to be equal for two stops to belong to one sweep.
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
/// The first difference in words, "seed 2 instead of 1"; empty where there is none.
[[nodiscard]] std::string difference(const Identity& got, const Identity& wanted);

struct StopsTable {
    std::string name;  ///< for messages: the file
    Identity identity{};
    std::vector<Row> rows{};
    std::size_t whole = 0;  ///< bytes up to the end of the last whole line
};

/// The first two lines.
[[nodiscard]] std::string head(const Identity& identity);
/// One stop as a line, its end included.
[[nodiscard]] std::string line(const Row& row);
[[nodiscard]] std::string to_csv(const Identity& identity, std::span<const Row> rows);

/// Throws settings::Error with `name` and line for what is no such table, of another version of it, or damaged; a last line without an
/// end is what a killed program leaves, and passed over. No stop stands in it twice.
[[nodiscard]] StopsTable parse_stops(const std::string& name, std::string_view csv);
[[nodiscard]] StopsTable read_stops(const std::filesystem::path& csv);
/// One line of line(), without its end.
[[nodiscard]] Row parse_row(const std::string& name, std::uint32_t line_number, std::string_view text);

}  // namespace sweep
