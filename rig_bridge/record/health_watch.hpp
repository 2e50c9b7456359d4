/// The wear room's judgement of a brake, from the summaries of a campaign to what its ledger keeps.
///
///     HealthWatch watch("config/wear/population.json");
///     catch_up(watch, ledger, rows);                        // a campaign that goes on
///     ledger.judge(summary.number, watch.after(summary));   // after each finished maneuver
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "rig_bridge/record/ledger.hpp"

namespace rig::record {

class HealthWatch {
  public:
    /// `model`: population.json of `rig-lab wear population`, or model.json of `rig-lab wear fit`. Throws settings::Error.
    explicit HealthWatch(const std::filesystem::path& model);
    ~HealthWatch();
    HealthWatch(const HealthWatch&) = delete;
    HealthWatch& operator=(const HealthWatch&) = delete;

    /// After a finished maneuver, in their order; others, and those out of tolerance, are passed over with the health of the one before.
    Health after(const Summary& summary);
    /// What the model was learnt from, for people.
    [[nodiscard]] std::string learnt_from() const;
    [[nodiscard]] const Health& newest() const { return newest_; }

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
    Health newest_;
};

/// Feeds the watch the finished maneuvers of `rows` (of the ledger's open campaign, oldest first) and judges those that nobody has judged: of a
/// bridge that died before it could, or of a time without a model.
void catch_up(HealthWatch& watch, Ledger& ledger, const std::vector<LedgerRow>& rows);

}  // namespace rig::record
