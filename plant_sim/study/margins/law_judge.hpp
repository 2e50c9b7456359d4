/// How good gains of the shipped law are: their stops first, then their margins in every cell.
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

/// What gains are worth: -2 - violation for stops that are not what is asked; -g / (1 + g), with g the fastest growth in 1/s of any cell that
/// is unstable, closed or the controller by itself; and, where all are stable, the least margin of all cells over what is asked. No cell is
/// left out, not even one that no controller could hold: low-speed numbers that lead there would be rewarded for it.
class LawJudge {
  public:
    /// All of them must outlive it. Throws std::invalid_argument where there is nothing to judge by.
    LawJudge(const std::vector<StopConditions>& scenarios, const TrialStops& trial, const StudyOptions& options);

    /// As Score of search.hpp.
    [[nodiscard]] double score(const antiskid::control::Config& controller, double to_beat) const;

    /// The margins alone, of every cell; `value` as in score().
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
    /// How many gains each place has ended: those that end the most are asked first. Threads race for it: it decides on time alone.
    mutable std::vector<std::atomic<unsigned>> ended_;
};

/// The gains that are searched, all of [slip]: k_p, k_i, k_d, k_dd, the answer's share, the three numbers of the fall at low speed. Not
/// those of the retreat, which no margin sees; not the observer.
[[nodiscard]] std::vector<std::string> gain_names();
[[nodiscard]] std::vector<double> gains_of(const antiskid::control::Config& config);
[[nodiscard]] antiskid::control::Config with_gains(antiskid::control::Config config, const std::vector<double>& values);

}  // namespace study::margins
