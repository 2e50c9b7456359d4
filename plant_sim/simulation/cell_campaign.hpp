/// Campaigns in a test cell of three programs that fail, on a simulated clock: the bridge's main loop, sequencer and Modbus client, controller
/// and served rig with its PLC, joined by the frames and requests that a real cell has. What must hold is looked at in every period, and in the
/// end the campaign has to come to its end once nothing fails any more.
///
/// Not in it: threads, disk, ledger and recordings (disk_campaign.hpp), and the terminal.
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
    bool resets = true;            ///< the bridge leads a tripped PLC back
    bool loop_proves_life = true;  ///< the client's watchdog moves just while the main loop does
    bool interlocks_trip = true;   ///< the PLC looks at its interlocks
    bool goes_on = true;           ///< a bridge that starts again goes on with the maneuver that was under way
};

/// A light landing from some 10 m/s, which takes a third of a minute. Throws as rig::bridge::load_setup does.
[[nodiscard]] CellSetup load_cell_setup(const std::filesystem::path& config);

struct CellOutcome {
    std::vector<std::string> violations;
    std::int64_t attempts = 0;
    std::int64_t finished = 0;
    double simulated_s = 0.0;
    std::map<std::string, std::int64_t> aborts;                ///< by cause
    std::array<std::int64_t, kCellFaultNames.size()> begun{};  ///< faults
    std::uint64_t frames_struck = 0, requests_struck = 0;

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
