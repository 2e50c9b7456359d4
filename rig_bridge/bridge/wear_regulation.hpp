/// A campaign whose slip reference shares wear between brake and tyre, maneuver by maneuver. The regulator's whole state follows from the rows
/// of the ledger: a bridge that was killed goes on with the reference that it would have had.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/scenario/scenario.hpp"
#include "rig_bridge/wear/life_forecast.hpp"
#include "rig_bridge/wear/regulation_config.hpp"

namespace rig {

class WearRegulation {
  public:
    /// The scenario's surface is seen beside those of the configuration. Throws settings::Error naming the file for a scenario without the slip law,
    /// on a surface that the floor's table does not have, or of a brake that has nothing left.
    WearRegulation(const regulation::RegulationConfig& config, const Scenario& scenario);

    /// As these rows, oldest first, leave it. A finished maneuver is a landing, of which figures that lack frames are not believed; an aborted
    /// one has spent its energies; the rest has not been. The brake's life is what its friction foretells, where the configuration asks for that and
    /// the newest kForecasts landings can tell; else the plan's.
    [[nodiscard]] regulation::Regulator after(const std::vector<LedgerRow>& rows) const;

    [[nodiscard]] const regulation::Plan& plan() const { return plan_; }

  private:
    regulation::Plan plan_;
    regulation::Rules rules_;
    regulation::Range range_;
    std::optional<regulation::LifeForecast> life_forecast_;  // before any landing
    plant::FrictionCurve friction_curve_;
    double drop_out_mps_;

    static constexpr std::size_t kForecasts = 32;  // each costs a millisecond or two
};

/// For the view and the log: "slip reference 0.262; ...".
[[nodiscard]] std::string line(const regulation::Regulator& regulator);

/// What `rig-bridge status` shows beside the ledger: reference, shares, what is left, landings to the limits. Derived: the ledger is the truth.
[[nodiscard]] inline std::filesystem::path regulation_file(const std::filesystem::path& directory, const std::string& campaign) {
    return directory / campaign / "regulation.json";
}
void write_regulation(const std::filesystem::path& file, const regulation::Regulator& regulator);

}  // namespace rig
