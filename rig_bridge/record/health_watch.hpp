/// Judges a brake's health from the summaries of a campaign, with the monitor of wear/health.hpp, for the ledger.
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

    /// Call after each maneuver, in order. Only finished ones within tolerance are judged; others return the previous health.
    Health after(const Summary& summary);
    /// Origin of the model, for people.
    [[nodiscard]] std::string learnt_from() const;
    [[nodiscard]] const Health& newest() const { return newest_; }

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
    Health newest_;
};

/// Feeds the watch the finished maneuvers of `rows` (of the ledger's open campaign, oldest first) and enters the health of those not judged yet: run
/// without a model, or before the bridge died.
void catch_up(HealthWatch& watch, Ledger& ledger, const std::vector<LedgerRow>& rows);

}  // namespace rig::record
