/// Many maneuvers in one process, several side by side on one thread: the same as run_in_process with Link::rounded, but faster.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "plant_sim/study/in_process.hpp"

namespace study {

/// Arguments of one maneuver, see run_in_process.
struct Maneuver {
    antiskid::control::Config controller;
    rig::RigParameters rig;
    SessionOptions options;
    StepObserver on_step{};  ///< may be empty
};

/// Returns the next maneuver; empty: there are no more, and it is not called again.
using NextManeuver = std::function<std::optional<Maneuver>()>;
/// Called when a maneuver has ended; `number` counts the calls of NextManeuver from 0. Short maneuvers may end before longer earlier ones.
using ManeuverDone = std::function<void(std::size_t number, const RunResult& result)>;

/// Runs all maneuvers. Each result has the same bits as that of run_in_process. `layout` must outlive the call. An exception of a function ends the
/// run.
void run_side_by_side(const antiskid::can::Layout& layout, const NextManeuver& next, const ManeuverDone& done);

}  // namespace study
