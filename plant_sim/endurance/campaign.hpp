/// An endurance campaign in process: one maneuver after the other in one TestCell, each entered into a ledger of the same format as the
/// bridge's. A campaign that was stopped goes on with the next maneuver, the brake as worn as it was.
///
/// No wall clock: `started` is the rig's own time, counted from 1970-01-01T00:00:00Z. Same seed, same configuration: same rows.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "plant_sim/endurance/setup.hpp"
#include "rig_bridge/record/ledger.hpp"

namespace endurance {

struct CampaignOptions {
    std::int64_t maneuvers = 500;
    std::uint64_t seed = 1;  ///< below 2^63
    std::filesystem::path ledger;
    const std::atomic<bool>* stop = nullptr;  ///< looked at between two maneuvers
};

struct CampaignResult {
    std::vector<rig::Summary>
        finished;              ///< every finished maneuver of the ledger, also those of earlier runs
    std::int64_t already = 0;  ///< of them
    bool aborted = false;      ///< a maneuver was: the campaign stopped there
    rig::Summary last;         ///< the newest maneuver, e.g. the aborted one
};

/// After each maneuver, with its number among `planned`.
using CampaignObserver = std::function<void(const rig::Summary&, std::int64_t planned)>;

/// Throws rig::LedgerError, and settings::Error where the ledger holds this campaign with another seed or configuration.
[[nodiscard]] CampaignResult run_campaign(const Setup& setup, const CampaignOptions& options,
                                          const CampaignObserver& observe = {});

}  // namespace endurance
