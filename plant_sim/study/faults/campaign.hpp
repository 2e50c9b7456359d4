/// The runs of a plan on every core.
#pragma once

#include <atomic>
#include <functional>
#include <span>
#include <vector>

#include "plant_sim/study/faults/plan.hpp"
#include "plant_sim/study/faults/run.hpp"

namespace faults {

struct Row {
    Case run;
    Result result;
};

struct CampaignOptions {
    unsigned threads = 1;  ///< at least 1; results do not depend on it
    const std::atomic<bool>* stop =
        nullptr;  ///< once true, runs that have begun are finished and no other is
    std::function<void(std::size_t done)> progress{};  ///< by any thread, one at a time
};

/// Runs `numbers` of the plan; those that are finished, in the order given. Throws as run_sound.
[[nodiscard]] std::vector<Row> run_campaign(const Plan& plan, std::span<const std::size_t> numbers,
                                            const CampaignOptions& options);

}  // namespace faults
