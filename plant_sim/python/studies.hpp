/// Studies as the verbs of the same names run them; Ctrl-C ends them.
#pragma once

#include <string>

#include "plant_sim/scenario/stop_options.hpp"
#include "plant_sim/study/margins/cells.hpp"
#include "plant_sim/study/robust/robust_campaign.hpp"
#include "plant_sim/study/sweep/sweep_plan.hpp"

namespace plant_sim::python {

/// Texts of results.json and stops.csv.
struct StudyFiles {
    std::string results, stops;
};

/// `threads`: 0: all cores. The caller must hold Python's lock, which is released during the run.
[[nodiscard]] StudyFiles sweep_study(const sweep::SweepPlanOptions& options, unsigned threads);
[[nodiscard]] StudyFiles robust_study(const robust::RobustPlanOptions& options, unsigned threads);
/// Text of results.json. `scenario`: the verb's options; its slip reference replaces that of `options`.
[[nodiscard]] std::string margins_study(const StopOptions& scenario, study::margins::StudyOptions options);

}  // namespace plant_sim::python
