/// Output of `rig-lab regulate fleet`: table, fleet.json, visits.csv, fleet.png.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "plant_sim/study/regulation/fleet_study.hpp"

namespace plant_sim::lab {

struct FleetReport {
    regulation::FleetConfig config;
    std::vector<regulation::Judged> policies;  ///< the plainest first
    std::string config_hash;

    /// The cheapest of those that an owner can choose, that is without the one that has a bay for each aircraft.
    [[nodiscard]] const regulation::Judged& cheapest() const;
    /// The plainest that costs no more than the cheapest one, or by no more than two standard errors.
    [[nodiscard]] const regulation::Judged& recommended() const;
};

[[nodiscard]] std::string to_text(const FleetReport& report);
[[nodiscard]] std::string to_json(const FleetReport& report);
/// All visits of all fleets under all policies.
[[nodiscard]] std::string to_csv(const FleetReport& report);
/// Cost by policy, and the visits of one fleet's first year under the plainest policy and the recommended one. Throws std::runtime_error if gnuplot
/// fails.
void draw(const FleetReport& report, const std::filesystem::path& png);

}  // namespace plant_sim::lab
