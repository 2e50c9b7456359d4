/// What the rig's brake really took in each attempt, against what the ledger has of it.
#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/control/types.hpp"
#include "rig_bridge/record/ledger.hpp"

namespace plant_sim::simulation {

class EnergyAccount {
  public:
    /// `landing_J`: what the brake takes in one that nothing disturbs, about.
    explicit EnergyAccount(double landing_J) : landing_J_(landing_J) {}

    /// In every period; `taken_J` is of the brake's whole life, here and below.
    void pass(antiskid::control::Time now, double taken_J);
    /// Its recording begins: what the brake takes until the next one does is of this attempt.
    void begun(const std::filesystem::path& folder) { attempts_.push_back({.folder = folder, .before_J = taken_J_}); }
    /// A bridge dies, and with the power the end of its recording.
    void bridge_ended();

    /// Which of the rows do not fit.
    [[nodiscard]] std::vector<std::string> check(std::span<const rig::record::LedgerRow> rows) const;

  private:
    struct Attempt {
        std::filesystem::path folder;
        double before_J = 0.0;
        std::optional<double> sure_J{};  ///< until what is written for certain, where its bridge died
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

}  // namespace plant_sim::simulation
