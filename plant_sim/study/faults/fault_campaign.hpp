/// One run: the stop in process, with real frames and the real controller, and the fault between them; and the runs of a plan on every core.
#pragma once

#include <atomic>
#include <functional>
#include <span>
#include <vector>

#include "plant_sim/study/faults/fault_plan.hpp"
#include "plant_sim/study/faults/judge.hpp"
#include "plant_sim/study/in_process.hpp"

namespace faults {

/// The same stop without a fault. Throws std::runtime_error where it names faults or does not come to rest: nothing could be said about one
/// with a fault.
struct Sound {
    double distance_m = 0.0;  ///< from brake-on to standstill
    double lasts_s = 0.0;     ///< from the start of the run to its end
    antiskid::control::FaultSet named;
};
[[nodiscard]] Sound run_sound(const FaultPlan& plan, const Case& c);

struct Result {
    Judgement verdict;
    double begun_s = -1.0;  ///< when the fault began; negative: the stop ended before
    double begun_mps = 0.0;
};
/// `sound` is that of `c`. `on_step` may be empty.
[[nodiscard]] Result run_one(const FaultPlan& plan, const Case& c, const Sound& sound, const study::StepObserver& on_step = {});

struct Row {
    Case run;
    Result result;
};

struct CampaignOptions {
    unsigned threads = 1;                              ///< at least 1; results do not depend on it
    const std::atomic<bool>* stop = nullptr;           ///< once true, runs that have begun are finished and no other is
    std::function<void(std::size_t done)> progress{};  ///< by any thread, one at a time
};

/// Runs `numbers` of the plan; those that are finished, in the order given. Throws as run_sound.
[[nodiscard]] std::vector<Row> run_campaign(const FaultPlan& plan, std::span<const std::size_t> numbers, const CampaignOptions& options);

}  // namespace faults
