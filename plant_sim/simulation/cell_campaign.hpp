/// Campaigns in a test cell of three programs that fail, on simulated clocks and a simulated disk: the bridge's main loop, sequencer, Modbus
/// client, recorder and ledger, controller and served rig with its PLC, joined by the frames and requests that a real cell has. What must hold is
/// looked at in every period, and on the disk whenever a bridge has ended; in the end the campaign has to come to its end once nothing fails any
/// more.
///
/// Not in it: threads, the terminal, and the 0.3 s of the bus that a bridge records before it settles what the one before has left.
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

/// What the three programs are run with: a test of the invariants puts its mistakes in here.
struct CellSetup {
    rig::bridge::BridgeSetup bridge;
    antiskid::control::Config controller;
    plc::ServedRigOptions machinery;
    // What is held against, whatever the two above say.
    double permission_s = 0.0;      ///< for which a permission holds
    rig::bridge::Freshness limits;  ///< for which the bridge may go on without hearing of PLC or controller

    // Mistakes.
    BridgeMistake mistake = BridgeMistake::none;
    bool interlocks_trip = true;  ///< the PLC looks at its interlocks

    /// For a test that has allocations of the bridge fail, those of its main loop apart.
    AllocationGate::Hook allocations = {};
};

/// A light landing from some 10 m/s, which takes a third of a minute. Throws as rig::bridge::load_setup does.
[[nodiscard]] CellSetup load_cell_setup(const std::filesystem::path& config);

struct CellOutcome {
    std::vector<std::string> violations;
    std::int64_t attempts = 0;
    std::int64_t finished = 0;
    std::int64_t starts = 0;       ///< of the bridge
    std::int64_t refusals = 0;     ///< ends of it because disk or memory refused
    std::uint64_t damaged = 0;     ///< logs of which the reader says so, each time that it looked
    std::uint64_t operations = 0;  ///< of the disk
    double simulated_s = 0.0;
    std::map<std::string, std::int64_t> aborts;                ///< by cause
    std::array<std::int64_t, kCellFaultNames.size()> begun{};  ///< faults
    std::uint64_t frames_struck = 0, requests_struck = 0;
    std::array<std::uint64_t, kDiskFaultNames.size()> disk_struck{};

    CellOutcome& operator+=(const CellOutcome& other);
};

/// Takes a line for what happens.
using CellTrace = std::function<void(const std::string& line)>;

/// Everything but `faults` is drawn from `seed`. Stops at the first violation.
[[nodiscard]] CellOutcome run_cell_campaign(const CellSetup& setup, std::uint64_t seed, std::span<const PlannedFault> faults,
                                            const CellTrace& trace = {});
/// The faults of this seed.
[[nodiscard]] std::vector<PlannedFault> faults_of(std::uint64_t seed);
/// Of `faults`, with which the campaign violates something, those without which it does not; each as short as halving makes it.
[[nodiscard]] std::vector<PlannedFault> fewest_faults(const CellSetup& setup, std::uint64_t seed, std::vector<PlannedFault> faults);

}  // namespace plant_sim::simulation
