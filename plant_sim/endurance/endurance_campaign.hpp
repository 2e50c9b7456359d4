/// An endurance campaign in process: one maneuver after the other in one TestCell, each entered into a ledger of the same format as the
/// bridge's. A campaign that was stopped goes on with the next maneuver, the brake as worn as it was: before each maneuver the brake is what the
/// ledger says of it, so that friction follows from seed, number and ledger alone.
///
/// No wall clock: `started` is the rig's own time, counted from 1970-01-01T00:00:00Z. Same seed, same configuration: same rows.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "plant_sim/endurance/endurance_setup.hpp"
#include "rig_bridge/record/ledger.hpp"

namespace endurance {

struct CampaignOptions {
    std::int64_t maneuvers = 500;
    std::uint64_t seed = 1;  ///< below 2^63
    std::filesystem::path ledger;
    std::filesystem::path wear_model{};               ///< that judges the brake's health after each maneuver; empty: nobody does
    const std::atomic<bool>* stop = nullptr;          ///< looked at between two maneuvers
    double taken_J = 0.0;                             ///< by the brake before the campaign
    std::optional<wear::ConditionalRule> by_model{};  ///< friction is drawn from the model by this rule; none: by the rig's law where it has one
    /// Read before the first maneuver where it is there (then instead of `taken_J` and, for the wear, of `seed`), written after each;
    /// empty: none.
    std::filesystem::path brake_state{};
};

struct CampaignResult {
    std::vector<rig::record::Summary> finished;  ///< every finished maneuver of the ledger, also those of earlier runs
    std::int64_t already = 0;                    ///< of them
    bool aborted = false;                        ///< a maneuver was: the campaign stopped there
    rig::record::Summary last;                   ///< the newest maneuver, e.g. the aborted one
    std::optional<wear::WearingBrake> brake;     ///< as it is at the end
    rig::record::Health health;                  ///< of the brake; unknown without a model
    std::string judged_by{};                     ///< what the model was learnt from
};

/// After each maneuver, with its number among `planned`.
using CampaignObserver = std::function<void(const rig::record::Summary&, std::int64_t planned)>;

/// Throws rig::record::LedgerError; settings::Error where the ledger holds this campaign with another seed, configuration, rule or brake, and for a
/// brake state that is not of this brake or not of this campaign.
[[nodiscard]] CampaignResult run_campaign(const EnduranceSetup& setup, const CampaignOptions& options, const CampaignObserver& observe = {});

}  // namespace endurance
