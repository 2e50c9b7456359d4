/// Many maneuvers in process, several side by side on one thread: what run_in_process does with Link::rounded, faster.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "plant_sim/study/in_process.hpp"

namespace study {

/// One maneuver, as handed to run_in_process.
struct Maneuver {
    antiskid::control::Config controller;
    rig::RigParameters rig;
    SessionOptions options;
    StepObserver on_step{};  ///< may be empty
};

/// Called for one maneuver after the other, whenever there is room; empty: there are no more, and it is not called again.
using NextManeuver = std::function<std::optional<Maneuver>()>;
/// Called when a maneuver has ended, with its number in the order of the calls above, counted from 0. A short one may overtake a long one.
using ManeuverDone = std::function<void(std::size_t number, const RunResult& result)>;

/// Runs them all. Every result has the same bits as that of run_in_process, whatever runs beside it. `layout` must outlive the call. What
/// a function throws ends the run.
void run_side_by_side(const antiskid::can::Layout& layout, const NextManeuver& next, const ManeuverDone& done);

}  // namespace study
