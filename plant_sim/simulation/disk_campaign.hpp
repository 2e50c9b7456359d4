/// Campaigns of made maneuvers by the real recorder, summary and ledger on a simulated disk that fails, and what must hold after each failure.
///
/// A campaign is run as `rig-bridge campaign` runs one: begin in the ledger, bus.log, summary.json, finish in the ledger, said to be finished. The
/// program dies where the power is cut or it is killed, and ends where the disk refuses what it cannot do without; it is then started again, until
/// the campaign is complete. A maneuver is frames that are numbered, each of which stands for a joule.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "plant_sim/simulation/campaign_books.hpp"
#include "rig_bridge/record/ledger.hpp"

namespace plant_sim::simulation {

/// What the campaign is run with: a test of the invariants puts its mistakes in here.
struct Hands {
    /// The disk as recorder, summary and ledger get it.
    std::function<std::shared_ptr<const settings::Storage>(std::shared_ptr<const SimulatedDisk>)> storage = [](auto disk) { return disk; };
    bool durable = true;  ///< LedgerOptions::durable
    SqliteLapse lapse = SqliteLapse::none;
    /// J in the campaign before the next maneuver.
    std::function<double(const rig::record::Ledger&)> taken_J = [](const auto& ledger) { return ledger.cumulative_energy_J(); };
    /// What is believed of a log.
    CampaignBooks::Reading reading = {};
    /// A maneuver is said to be finished before the ledger has it.
    bool says_early = false;
    /// A record of which lines are missing counts as whole.
    bool counts_lost = false;
};

struct CampaignOutcome {
    std::vector<std::string> violations;
    std::int64_t maneuvers = 0;  ///< begun
    std::uint64_t starts = 0;    ///< of the program
    std::uint64_t operations = 0;
    std::uint64_t damaged = 0;   ///< logs of which the reader says so, each time that it looked
    std::uint64_t refusals = 0;  ///< ends of the program because the disk refused
    std::array<std::uint64_t, kDiskFaultNames.size()> struck{};

    CampaignOutcome& operator+=(const CampaignOutcome& other);
};

/// Everything is drawn from `seed`. `trace` takes what happens, line by line.
[[nodiscard]] CampaignOutcome run_disk_campaign(std::uint64_t seed, const Hands& hands = {}, const DiskTrace& trace = {});

}  // namespace plant_sim::simulation
