/// Recorded stops for learning friction curves, from several kinds of sources.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/host/settings/config_directory.hpp"
#include "plant_sim/wear/dynamics.hpp"

namespace plant_sim::lab {

/// `[CLASS=]PATH`. CLASS is a friction class (light, medium, heavy), a maneuver of maneuvers.toml, or endurance; it determines the brake. Without it,
/// the scenario in the folder's summary.json does. PATH is a bus log (candump format, plain or gzip), the folder of a maneuver, the folder of a
/// campaign or its ledger (all its finished maneuvers), or a CSV for parse_stop().
struct StopSource {
    std::string kind;  ///< CLASS; empty: not given
    std::filesystem::path path;
};
[[nodiscard]] StopSource parse_source(const std::string& text);

/// The stops of one friction class.
struct ClassStops {
    std::string friction_class;
    std::vector<wear::RecordedStop> stops;
};

struct StopFiles {
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path dbc;                     ///< empty: antiskid.dbc of `config`
    std::filesystem::path binding;                 ///< empty: antiskid_binding.toml of `config`
    std::function<void(const std::string&)> warn;  ///< called with a line about a log
};

/// Classes in the order light, medium, heavy, without those that have no stop. Throws settings::Error naming file and line.
[[nodiscard]] std::vector<ClassStops> load_stops(const std::vector<StopSource>& sources, const StopFiles& files);

/// CSV with the columns time_s, speed_mps, pressure_Pa, brake_torque_Nm in any order, among others. Empty lines and lines that begin with # are
/// ignored. Brake-on is the sample before the first with more than 2 % of the greatest pressure. Throws settings::Error with `name` and line.
[[nodiscard]] wear::RecordedStop parse_stop(const std::string& name, std::string_view csv, double brake_gain_m3);

}  // namespace plant_sim::lab
