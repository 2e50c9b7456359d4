/// The stops of a plan in closed loop on all cores: sensors, rounding by the codec, the real controller, the plant.
#pragma once

#include <atomic>
#include <functional>
#include <span>
#include <vector>

#include "firmware/control/types.hpp"
#include "plant_sim/study/stop_meter.hpp"
#include "plant_sim/study/sweep/sweep_plan.hpp"

namespace sweep {

struct SweptStop {
    Stop stop;
    study::StopFigures figures;
    antiskid::control::FaultSet faults;
};

struct RunOptions {
    unsigned threads = 1;                            ///< >= 1; figures do not depend on it
    const std::atomic<bool>* stop = nullptr;         ///< once true, stops that have begun are finished and no others start
    std::function<void(const SweptStop&)> on_row{};  ///< called with each finished stop by any thread, one at a time
};

/// Starts stops `numbers` of the plan in that order; returns the finished ones in the order of their numbers. An exception of a stop or of on_row
/// ends the run and is thrown.
std::vector<SweptStop> run(const SweepPlan& plan, std::span<const std::size_t> numbers, const RunOptions& options);

}  // namespace sweep
