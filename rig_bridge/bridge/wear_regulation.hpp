/// Chooses the slip reference of each maneuver of a campaign to share wear between brake and tyre. The regulator's state follows from the rows of the
/// ledger alone, so that a restarted bridge continues with the same reference.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/rig/scenario.hpp"
#include "rig_bridge/wear/life_forecast.hpp"
#include "rig_bridge/wear/life_readings.hpp"
#include "rig_bridge/wear/regulation_config.hpp"

namespace rig::bridge {

class WearRegulation {
  public:
    /// Adds the scenario's surface to those of the configuration. Throws settings::Error naming the file for a scenario without the slip law, on a
    /// surface that is not in the floor table, or with a worn-out brake.
    WearRegulation(const wear::RegulationConfig& config, const Scenario& scenario);

    /// The regulator after these rows, oldest first. A finished maneuver counts as a landing (figures with missing frames are not used), an aborted
    /// one by its energies, others not at all. Lives of brake and tyre are the plan's, corrected by what was read of their wear (of the first tyre
    /// only, which the plan is for). Until the lining is read, the brake's is forecast from its friction if the configuration asks for it and the
    /// newest kForecasts landings allow it.
    [[nodiscard]] wear::Regulator after(const std::vector<record::LedgerRow>& rows) const;

    [[nodiscard]] const wear::WearPlan& plan() const { return plan_; }

  private:
    wear::WearPlan plan_;
    wear::Rules rules_;
    wear::Range range_;
    wear::LifeReadings lining_, tread_;  // before any landing, as the next
    std::optional<wear::LifeForecast> life_forecast_;
    rig::FrictionCurve friction_curve_;
    double drop_out_mps_;

    static constexpr std::size_t kForecasts = 32;  // each costs a millisecond or two
};

/// Line for the view and the log: "slip reference 0.262; ...".
[[nodiscard]] std::string line(const wear::Regulator& regulator);

/// What `rig-bridge status` shows beside the ledger: reference, shares, what is left, landings to the limits. Derived from the ledger, which is
/// authoritative.
[[nodiscard]] inline std::filesystem::path regulation_file(const std::filesystem::path& directory, const std::string& campaign) {
    return directory / campaign / "regulation.json";
}
void write_regulation(const std::filesystem::path& file, const wear::Regulator& regulator);

}  // namespace rig::bridge
