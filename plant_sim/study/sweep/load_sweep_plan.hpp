/// A sweep's plan from the files in config/.
#pragma once

#include <filesystem>

#include "firmware/host/settings/config_directory.hpp"
#include "plant_sim/study/sweep/sweep_plan.hpp"

namespace sweep {

struct SweepPlanOptions {
    std::filesystem::path config = settings::config_directory();
    std::vector<double> references = paper_references();
    std::size_t landings = kPaperLandings;
    bool threshold = true;
    std::uint64_t seed = 1;
};

/// All surfaces times all maneuvers of `config`. Throws settings::Error naming file, line and key.
[[nodiscard]] SweepPlan load_plan(const SweepPlanOptions& options);

}  // namespace sweep
