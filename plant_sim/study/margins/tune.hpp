/// Gains by their margins: what `rig-lab tune` maximises.
#pragma once

#include <vector>

#include "plant_sim/study/margins/cells.hpp"
#include "plant_sim/study/margins/search.hpp"

namespace study::margins {

/// How much of what is asked a loop has: the least of phase margin, upward and downward gain margin, each over the requirement; below zero
/// where the loop is unstable. 1 and more meets it.
[[nodiscard]] double score(const Margins& margins, const Requirement& requirement);

/// Score of a loop over all cells that `Limits` allow. Where some are unstable: minus their share; else the least.
struct WorstScore {
    double value = 0.0;
    int unstable = 0;
    int met = 0;
    int counted = 0;
};

/// Step of the walk along the axis that is good enough here: the margins stay exact, what is found between steps is not near -1.
inline constexpr double kCoarseWalk = 1.2;

/// Operating points of a study, without their margins: what tuning goes over again and again.
struct TuningCell {
    std::size_t scenario = 0;
    OperatingPoint at;
};
[[nodiscard]] std::vector<TuningCell> tuning_cells(const std::vector<Scenario>& scenarios, const antiskid::control::Config& controller,
                                                   const StudyOptions& options);

[[nodiscard]] WorstScore pid_score(const Pid& pid, const std::vector<Scenario>& scenarios, const std::vector<TuningCell>& cells,
                                   const Requirement& requirement);
/// k_p, k_i, k_d and the schedule's power, within the bounds that docs/engineering/margins.md states; the filter stays.
[[nodiscard]] std::vector<Parameter> pid_parameters(const Pid& start);
[[nodiscard]] Pid with(Pid pid, const std::vector<double>& values);

}  // namespace study::margins
