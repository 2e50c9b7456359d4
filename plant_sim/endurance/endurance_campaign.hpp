/// An endurance campaign in one process: maneuvers in a TestCell, each entered into a ledger of the bridge's format. A campaign that was stopped
/// continues with its next maneuver. Before each maneuver the brake's state is taken from the ledger, so that friction depends only on seed, number
/// and ledger.
///
/// The wall clock is not used: `started` is rig time, counted from 1970-01-01T00:00:00Z. The same seed and configuration give the same rows.
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
    std::filesystem::path wear_model{};               ///< for the brake's health after each maneuver; empty: health is not judged
    const std::atomic<bool>* stop = nullptr;          ///< checked between two maneuvers
    double taken_J = 0.0;                             ///< energy taken by the brake before the campaign
    std::optional<wear::ConditionalRule> by_model{};  ///< friction is drawn from the model by this rule; none: by the rig's law, if it has one
    /// State of the brake; empty: none is kept. If the file exists, it is read before the first maneuver and replaces `taken_J` and, for the wear,
    /// `seed`. It is written after each maneuver.
    std::filesystem::path brake_state{};
};

struct CampaignResult {
    std::vector<rig::record::Summary> finished;  ///< all finished maneuvers of the ledger, earlier runs included
    std::int64_t earlier = 0;                    ///< number of them from earlier runs
    bool aborted = false;                        ///< whether a maneuver was aborted, which ends the campaign
    rig::record::Summary last;                   ///< the newest maneuver, e.g. the aborted one
    std::optional<wear::WearingBrake> brake;     ///< at the end
    rig::record::Health health;                  ///< of the brake; unknown without `wear_model`
    std::string model_origin{};                  ///< data from which the model was learnt
};

/// Called after each maneuver. `planned`: number of maneuvers of the campaign.
using CampaignObserver = std::function<void(const rig::record::Summary&, std::int64_t planned)>;

/// Throws rig::record::LedgerError; settings::Error if the ledger holds this campaign with another seed, configuration, rule or brake, or if the
/// brake's state is of another brake or campaign.
[[nodiscard]] CampaignResult run_campaign(const EnduranceSetup& setup, const CampaignOptions& options, const CampaignObserver& observe = {});

}  // namespace endurance
