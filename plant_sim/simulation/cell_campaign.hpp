/// Campaigns in a test cell whose three programs fail, on simulated clocks and a simulated disk: the bridge's main loop, sequencer, Modbus client,
/// recorder and ledger, the controller, and the served rig with its PLC. They exchange the frames and requests of a real cell. The invariants are
/// checked in every period, and those of the disk whenever a bridge has ended. After the last fault the campaign has to complete.
///
/// Not simulated: threads, the terminal, and the 0.3 s of bus that a bridge records before it settles attempts of its predecessor.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "firmware/control/config.hpp"
#include "plant_sim/plc/served_rig.hpp"
#include "plant_sim/simulation/bridge_program.hpp"
#include "plant_sim/simulation/cell_faults.hpp"
#include "rig_bridge/bridge/bridge_setup.hpp"

namespace plant_sim::simulation {

/// Settings of the three programs, and seeded mistakes for tests of the invariants.
struct CellSetup {
    rig::bridge::BridgeSetup bridge;
    antiskid::control::Config controller;
    plc::ServedRigOptions machinery;
    // Limits for the checks, independent of the settings above.
    double permission_s = 0.0;      ///< longest time for which a permission is valid
    rig::bridge::Freshness limits;  ///< longest times for which the bridge may go on without data of PLC or controller

    // Mistakes.
    BridgeMistake mistake = BridgeMistake::none;
    bool interlocks_trip = true;  ///< false: the PLC ignores its interlocks

    /// For a test in which the bridge's allocations fail, except those of its main loop.
    AllocationGate::Hook allocations = {};
};

/// A light landing from about 10 m/s; simulated time of a third of a minute. Throws as rig::bridge::load_setup does.
[[nodiscard]] CellSetup load_cell_setup(const std::filesystem::path& config);

struct CellOutcome {
    std::vector<std::string> violations;
    std::int64_t attempts = 0;
    std::int64_t finished = 0;
    std::int64_t starts = 0;       ///< of the bridge
    std::int64_t refusals = 0;     ///< bridges that ended because disk or memory refused
    std::uint64_t damaged = 0;     ///< number of readings of logs that reported damage
    std::uint64_t operations = 0;  ///< of the disk
    double simulated_s = 0.0;
    std::map<std::string, std::int64_t> aborts;                ///< by cause
    std::array<std::int64_t, kCellFaultNames.size()> begun{};  ///< faults, by kind
    std::uint64_t faulted_frames = 0, faulted_requests = 0;
    std::array<std::uint64_t, kDiskFaultNames.size()> disk_fault_counts{};

    CellOutcome& operator+=(const CellOutcome& other);
};

/// Called with a line for each event.
using CellTrace = std::function<void(const std::string& line)>;

/// Draws all but `faults` from `seed`. Stops at the first violation.
[[nodiscard]] CellOutcome run_cell_campaign(const CellSetup& setup, std::uint64_t seed, std::span<const PlannedFault> faults,
                                            const CellTrace& trace = {});
/// The faults of a seed.
[[nodiscard]] std::vector<PlannedFault> faults_of(std::uint64_t seed);
/// For `faults` that lead to a violation: a subset that still does, without which there is none, each fault shortened by halving.
[[nodiscard]] std::vector<PlannedFault> fewest_faults(const CellSetup& setup, std::uint64_t seed, std::vector<PlannedFault> faults);

}  // namespace plant_sim::simulation
