/// Recomputes figures and warnings from the recordings of finished maneuvers, and compares them with summary and ledger.
#pragma once

#include <filesystem>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "plant_sim/simulation/simulated_disk.hpp"
#include "rig_bridge/bridge/bridge_setup.hpp"
#include "rig_bridge/record/ledger.hpp"

namespace plant_sim::simulation {

class RecomputedFigures {
  public:
    /// `setup` must outlive it.
    RecomputedFigures(const rig::bridge::BridgeSetup& setup, std::shared_ptr<const SimulatedDisk> disk) : setup_(setup), disk_(std::move(disk)) {}

    /// Rows that differ, as text. Checks only rows that no earlier call has checked.
    [[nodiscard]] std::vector<std::string> check(std::span<const rig::record::LedgerRow> rows);

  private:
    const rig::bridge::BridgeSetup& setup_;
    std::shared_ptr<const SimulatedDisk> disk_;
    std::set<std::filesystem::path> seen_;
};

}  // namespace plant_sim::simulation
