/// Scores gains of the shipped law: first by its stops, then by its margins in every cell.
#pragma once

#include <atomic>
#include <cstddef>
#include <string>
#include <vector>

#include "plant_sim/study/margins/cells.hpp"
#include "plant_sim/study/margins/search.hpp"
#include "plant_sim/study/margins/trial_stops.hpp"
#include "plant_sim/study/margins/tune.hpp"

namespace study::margins {

/// The score: -2 - violation for stops that miss the requirement; otherwise -g / (1 + g) if some cell is unstable, closed or the controller alone,
/// with g its fastest growth in 1/s; otherwise the smallest margin of all cells over the requirement. All cells count, also those that no controller
/// could hold: otherwise gains whose reference at low speed leads there would be rewarded.
class LawJudge {
  public:
    /// All arguments must outlive it. Throws std::invalid_argument if there is nothing to judge by.
    LawJudge(const std::vector<StopConditions>& scenarios, const TrialStops& trial, const StudyOptions& options);

    /// See Score of search.hpp.
    [[nodiscard]] double score(const antiskid::control::Config& controller, double to_beat) const;

    /// Only the margins of every cell; `value` as in score().
    [[nodiscard]] WorstScore margins_of(const antiskid::control::Config& controller) const;

  private:
    struct Place {
        std::size_t scenario;
        double speed_mps;
    };
    [[nodiscard]] double cell(const antiskid::control::Config& controller, const Place& place) const;
    [[nodiscard]] std::vector<std::size_t> hardest_first() const;

    const std::vector<StopConditions>& scenarios_;
    const TrialStops& trial_;
    StudyOptions options_;
    std::vector<Place> places_;
    /// Number of gains rejected by each place: the places with the most are tried first. Threads write it without order, which affects only the run
    /// time.
    mutable std::vector<std::atomic<unsigned>> ended_;
};

/// The gains that are searched, all of [slip]: k_p, k_i, k_d, k_dd, k_pole, the three parameters of the fall at low speed. Not included: the
/// parameters of the retreat, on which no margin depends, and the observer.
[[nodiscard]] std::vector<std::string> gain_names();
[[nodiscard]] std::vector<double> gains_of(const antiskid::control::Config& config);
[[nodiscard]] antiskid::control::Config with_gains(antiskid::control::Config config, const std::vector<double>& values);

}  // namespace study::margins
