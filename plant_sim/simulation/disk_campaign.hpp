/// Campaigns of artificial maneuvers on a simulated disk that fails, with the real recorder, summary and ledger; the invariants are checked after
/// each failure.
///
/// The order is that of `rig-bridge campaign`: begin in the ledger, bus.log, summary.json, finish in the ledger, report as finished. The program dies
/// when the power is cut or it is killed, and ends when the disk refuses what it needs; it is restarted until the campaign is complete. A maneuver
/// consists of numbered frames; each stands for one joule.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "plant_sim/simulation/campaign_audit.hpp"
#include "rig_bridge/record/ledger.hpp"

namespace plant_sim::simulation {

/// Parts of the program that a test of the invariants may replace by mistaken ones.
struct DiskCampaignSetup {
    /// The storage that recorder, summary and ledger use.
    std::function<std::shared_ptr<const settings::Storage>(std::shared_ptr<const SimulatedDisk>)> storage = [](auto disk) { return disk; };
    bool durable = true;  ///< LedgerOptions::durable
    SqliteDeviation deviation = SqliteDeviation::none;
    /// Energy of the campaign before the next maneuver, J.
    std::function<double(const rig::record::Ledger&)> taken_J = [](const auto& ledger) { return ledger.cumulative_energy_J(); };
    /// Replaces the result of reading a log.
    CampaignAudit::Reading reading = {};
    /// Mistake: a maneuver is reported as finished before it is in the ledger.
    bool says_early = false;
    /// Mistake: a record with missing lines counts as complete.
    bool counts_lost = false;
};

struct CampaignOutcome {
    std::vector<std::string> violations;
    std::int64_t maneuvers = 0;  ///< number that were begun
    std::uint64_t starts = 0;    ///< of the program
    std::uint64_t operations = 0;
    std::uint64_t damaged = 0;   ///< number of readings of logs that reported damage
    std::uint64_t refusals = 0;  ///< programs that ended because the disk refused
    std::array<std::uint64_t, kDiskFaultNames.size()> fault_counts{};

    CampaignOutcome& operator+=(const CampaignOutcome& other);
};

/// Draws everything from `seed`. `trace` is called with a line for each event.
[[nodiscard]] CampaignOutcome run_disk_campaign(std::uint64_t seed, const DiskCampaignSetup& setup = {}, const DiskTrace& trace = {});

}  // namespace plant_sim::simulation
