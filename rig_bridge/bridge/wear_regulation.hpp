/// A campaign whose slip reference shares wear between brake and tyre, maneuver by maneuver. The regulator's whole state follows from the rows
/// of the ledger: a bridge that was killed goes on with the reference that it would have had.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/rig/scenario.hpp"
#include "rig_bridge/wear/life_forecast.hpp"
#include "rig_bridge/wear/regulation_config.hpp"

namespace rig::bridge {

class WearRegulation {
  public:
    /// The scenario's surface is seen beside those of the configuration. Throws settings::Error naming the file for a scenario without the slip law,
    /// on a surface that the floor's table does not have, or of a brake that has nothing left.
    WearRegulation(const wear::RegulationConfig& config, const Scenario& scenario);

    /// As these rows, oldest first, leave it. A finished maneuver is a landing, of which figures that lack frames are not believed; an aborted
    /// one has spent its energies; the rest has not been. The brake's life is what its friction foretells, where the configuration asks for that and
    /// the newest kForecasts landings can tell; else the plan's.
    [[nodiscard]] wear::Regulator after(const std::vector<record::LedgerRow>& rows) const;

    [[nodiscard]] const wear::WearPlan& plan() const { return plan_; }

  private:
    wear::WearPlan plan_;
    wear::Rules rules_;
    wear::Range range_;
    std::optional<wear::LifeForecast> life_forecast_;  // before any landing
    rig::FrictionCurve friction_curve_;
    double drop_out_mps_;

    static constexpr std::size_t kForecasts = 32;  // each costs a millisecond or two
};

/// For the view and the log: "slip reference 0.262; ...".
[[nodiscard]] std::string line(const wear::Regulator& regulator);

/// What `rig-bridge status` shows beside the ledger: reference, shares, what is left, landings to the limits. Derived: the ledger is the truth.
[[nodiscard]] inline std::filesystem::path regulation_file(const std::filesystem::path& directory, const std::string& campaign) {
    return directory / campaign / "regulation.json";
}
void write_regulation(const std::filesystem::path& file, const wear::Regulator& regulator);

}  // namespace rig::bridge
