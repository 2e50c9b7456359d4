/// Table III of the paper compared with measured maneuvers.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "rig_bridge/record/summary.hpp"

namespace endurance {

struct Distribution {
    double mean = 0.0;
    double deviation = 0.0;  ///< standard deviation
};

/// Quantities of the table in the order that every array here has: torque, load, speed, duration, length.
inline constexpr std::size_t kQuantities = 5;
struct Quantity {
    const char* name;
    const char* unit;
    const char* key;            ///< in JSON
    const char* mean_key;       ///< in [endurance] of flywheel_rig.toml
    const char* deviation_key;  ///< likewise
    double rig::record::Figures::*figure;
};
inline constexpr std::array<Quantity, kQuantities> kTableThree{{
    {"torque", "N m", "torque_Nm", "torque_Nm", "torque_deviation_Nm", &rig::record::Figures::mean_torque_Nm},
    {"load", "N", "load_N", "load_N", "load_deviation_N", &rig::record::Figures::mean_load_N},
    {"speed", "m/s", "speed_mps", "speed_mps", "speed_deviation_mps", &rig::record::Figures::brake_on_mps},
    {"duration", "s", "duration_s", "duration_s", "duration_deviation_s", &rig::record::Figures::duration_s},
    {"length", "m", "length_m", "length_m", "length_deviation_m", &rig::record::Figures::length_m},
}};

using TableThree = std::array<Distribution, kQuantities>;

/// The table as printed, from flywheel_rig.toml in `config`. Throws settings::Error.
[[nodiscard]] TableThree printed_table(const std::filesystem::path& config);

/// Mean and sample standard deviation; the deviation is 0 for fewer than two maneuvers, both are 0 for none.
[[nodiscard]] TableThree measured_table(std::span<const rig::record::Summary> maneuvers);

/// Table as text. `printed`: none for another rig than Table III's.
[[nodiscard]] std::string to_text(const TableThree& measured, const std::optional<TableThree>& printed);

struct CampaignFacts {
    std::string scenario, config_hash, version;
    std::uint64_t seed = 0;
};
[[nodiscard]] std::string to_json(const CampaignFacts& facts, std::span<const rig::record::Summary> maneuvers,
                                  const std::optional<TableThree>& printed);

}  // namespace endurance
