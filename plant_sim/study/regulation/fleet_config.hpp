/// Configuration of the fleet study, config/fleet.toml: aircraft, shop, the price of the ground, and by which laws and seeds policies are tuned and
/// judged.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "plant_sim/study/regulation/fleet.hpp"

namespace regulation {

/// Each aircraft of a fleet has a seed of its own.
inline constexpr int kMaxAircraft = 1000;

/// Fleets by name: `fleets` of each law, each with kMaxAircraft seeds, the first with those from `first_seed` on.
struct FleetSet {
    std::vector<wear::arena::Law> laws;
    std::uint64_t first_seed = 0;
    int fleets = 0;
};

struct FleetConfig {
    int aircraft = 0;
    FleetRules rules;  ///< without prices of parts, visit and distance, which are those of regulation.toml
    int inspection_landings = 0;
    FleetSet tuning, held_out;
};

/// Throws settings::Error naming file, line and key.
[[nodiscard]] FleetConfig load_fleet_config(const std::filesystem::path& file);

}  // namespace regulation
