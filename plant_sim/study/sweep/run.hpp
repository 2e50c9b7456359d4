/// The stops of a plan in closed loop on every core: sensors, codec rounding, the real controller, the plant.
#pragma once

#include <atomic>
#include <functional>
#include <span>
#include <vector>

#include "firmware/control/types.hpp"
#include "plant_sim/study/stop_meter.hpp"
#include "plant_sim/study/sweep/sweep_plan.hpp"

namespace sweep {

struct Row {
    Stop stop;
    study::StopFigures figures;
    antiskid::control::FaultSet faults;
};

struct RunOptions {
    unsigned threads = 1;                      ///< at least 1; figures do not depend on it
    const std::atomic<bool>* stop = nullptr;   ///< once true, stops that have begun are finished and no other is
    std::function<void(const Row&)> on_row{};  ///< called with each finished stop, one at a time, by any thread
};

/// Stop `number` of the plan alone.
[[nodiscard]] Row run_one(const SweepPlan& plan, std::size_t number);

/// Stops `numbers` of the plan, begun in that order; those that are finished come back in the order of their numbers. What a stop or on_row
/// throws ends the run and is thrown here.
std::vector<Row> run(const SweepPlan& plan, std::span<const std::size_t> numbers, const RunOptions& options);

}  // namespace sweep
