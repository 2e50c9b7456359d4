/// What must be true of a cell's ledger and recordings, whatever failed.
#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "firmware/control/types.hpp"
#include "plant_sim/simulation/simulated_disk.hpp"
#include "rig_bridge/bridge/bridge_setup.hpp"
#include "rig_bridge/record/ledger.hpp"

namespace plant_sim::simulation {

/// Compares the energy that the rig's brake took in each attempt with the ledger.
class EnergyAccount {
  public:
    /// `landing_J`: approximate energy of an undisturbed landing.
    explicit EnergyAccount(double landing_J) : landing_J_(landing_J) {}

    /// Call in every period. `taken_J`: energy of the brake's whole life.
    void advance(antiskid::control::Time now, double taken_J);
    /// Call when an attempt's recording begins. The brake's energy up to the next such call belongs to this attempt.
    void begun(const std::filesystem::path& folder) { attempts_.push_back({.folder = folder, .before_J = taken_J_}); }
    /// Call when a bridge ends; a power cut may lose the end of its recording.
    void bridge_ended();

    /// Rows whose energy is wrong, as text.
    [[nodiscard]] std::vector<std::string> check(std::span<const rig::record::LedgerRow> rows) const;

  private:
    struct Attempt {
        std::filesystem::path folder;
        double before_J = 0.0;
        std::optional<double> sure_J{};  ///< for an attempt whose bridge died: `taken_J` up to which the recording is certainly written
    };
    struct Sample {
        antiskid::control::Time at{};
        double taken_J = 0.0;
    };
    double landing_J_;
    std::vector<Attempt> attempts_;
    std::deque<Sample> lately_;
    double taken_J_ = 0.0;
};

/// Recomputes figures and warnings from the recordings of finished maneuvers, and compares them with summary and ledger.
class RecomputedFigures {
  public:
    /// `setup` must outlive it.
    RecomputedFigures(const rig::bridge::BridgeSetup& setup, std::shared_ptr<const SimulatedDisk> disk) : setup_(setup), disk_(std::move(disk)) {}

    /// Rows that differ, as text. Checks only rows that no earlier call has checked.
    [[nodiscard]] std::vector<std::string> check(std::span<const rig::record::LedgerRow> rows);

  private:
    const rig::bridge::BridgeSetup& setup_;
    std::shared_ptr<const SimulatedDisk> disk_;
    std::set<std::filesystem::path> seen_;
};

}  // namespace plant_sim::simulation
