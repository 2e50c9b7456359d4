/// A sweep that takes a second: few landings, none on ice, where a stop lasts two minutes.
#pragma once

#include <utility>
#include <vector>

#include "plant_sim/study/sweep/sweep_plan.hpp"

namespace small {

inline sweep::SweepPlan plan(std::uint64_t seed = 1, std::vector<double> references = {0.1, 0.24}) {
    sweep::SweepPlanOptions options;
    options.references = std::move(references);
    options.landings = 4;
    options.seed = seed;
    sweep::SweepPlan plan = sweep::load_plan(options);
    for (std::size_t i = 0; i < plan.landings.size(); ++i) plan.landings[i].scenario = i;
    return plan;
}

}  // namespace small
