/// Runs many maneuvers on several threads, several side by side on each.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

#include "plant_sim/study/side_by_side.hpp"

namespace study {

struct ManyOptions {
    unsigned threads = 1;
    const std::atomic<bool>* stop = nullptr;  ///< once true, running maneuvers are finished and no others start
};

/// Runs maneuvers 0 to `count` - 1, made by `make` on any thread. `done` is called by one thread at a time, in the order in which maneuvers end. Each
/// result is that of run_in_process with Link::rounded. An exception of a function ends the run.
void run_many(const antiskid::can::Layout& layout, std::size_t count, const std::function<Maneuver(std::size_t number)>& make,
              const std::function<void(std::size_t number, const RunResult& result)>& done, const ManyOptions& options);

}  // namespace study
