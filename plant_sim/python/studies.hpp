/// Studies as the verbs of the same names run them, until Ctrl-C.
#pragma once

#include <string>

#include "plant_sim/stop_options.hpp"
#include "plant_sim/study/margins/cells.hpp"
#include "plant_sim/study/robust/robust_campaign.hpp"
#include "plant_sim/study/sweep/sweep_plan.hpp"

namespace plant_sim::python {

/// The texts of results.json and stops.csv.
struct StudyFiles {
    std::string results, stops;
};

/// `threads`: 0 for all cores. Python's lock is held by the caller, and free meanwhile.
[[nodiscard]] StudyFiles sweep_study(const sweep::SweepPlanOptions& options, unsigned threads);
[[nodiscard]] StudyFiles robust_study(const robust::RobustPlanOptions& options, unsigned threads);
/// The text of results.json. Of `scenario` what the verb has options for; its slip reference goes before that of `options`.
[[nodiscard]] std::string margins_study(const StopOptions& scenario, study::margins::StudyOptions options);

}  // namespace plant_sim::python
