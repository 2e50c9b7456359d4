/// Scores gains by their margins, for `rig-lab tune`.
#pragma once

#include <vector>

#include "plant_sim/study/margins/cells.hpp"
#include "plant_sim/study/margins/search.hpp"

namespace study::margins {

/// The smallest of phase margin, upward and downward gain margin, each relative to the requirement; 1 or more meets it. Negative if the loop is
/// unstable.
[[nodiscard]] double score(const Margins& margins, const Requirement& requirement);

/// Score of a loop over all cells for which `Limits` allow the requirement. If some are unstable: minus their share; otherwise the smallest score.
struct WorstScore {
    double value = 0.0;
    int unstable = 0;
    int met = 0;
    int counted = 0;
};

/// Ratio of the steps along the axis for tuning. Margins stay exact; a coarser grid only misses points far from -1.
inline constexpr double kCoarseWalk = 1.2;

/// Operating point of a study, without its margins, for repeated use while tuning.
struct TuningCell {
    std::size_t scenario = 0;
    OperatingPoint at;
};
[[nodiscard]] std::vector<TuningCell> tuning_cells(const std::vector<StopConditions>& scenarios, const antiskid::control::Config& controller,
                                                   const StudyOptions& options);

[[nodiscard]] WorstScore pid_score(const Pid& pid, const std::vector<StopConditions>& scenarios, const std::vector<TuningCell>& cells,
                                   const Requirement& requirement);
/// k_p, k_i, k_d and the schedule's exponent, within the bounds of docs/engineering/margins.md; the filter is not tuned.
[[nodiscard]] std::vector<Parameter> pid_parameters(const Pid& start);
[[nodiscard]] Pid with(Pid pid, const std::vector<double>& values);

}  // namespace study::margins
