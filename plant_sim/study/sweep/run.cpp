#include "plant_sim/study/sweep/run.hpp"

#include <algorithm>

#include "plant_sim/study/run_many.hpp"

namespace sweep {

std::vector<SweptStop> run(const SweepPlan& plan, std::span<const std::size_t> numbers, const RunOptions& options) {
    std::vector<SweptStop> rows;
    rows.reserve(numbers.size());
    study::run_many(
        plan.layout, numbers.size(),
        [&](std::size_t i) {
            return study::Maneuver{plan.controller, plan.rig(numbers[i]), plan.session(numbers[i])};
        },
        [&](std::size_t i, const study::RunResult& result) {
            SweptStop row{.stop = plan.stop(numbers[i]), .figures = result.figures, .faults = result.faults};
            if (options.on_row) options.on_row(row);
            rows.push_back(std::move(row));
        },
        {.threads = options.threads, .stop = options.stop});
    std::sort(rows.begin(), rows.end(), [](const SweptStop& a, const SweptStop& b) { return a.stop.number < b.stop.number; });
    return rows;
}

}  // namespace sweep
