/// Many maneuvers on several threads, several side by side on each.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

#include "plant_sim/study/side_by_side.hpp"

namespace study {

struct ManyOptions {
    unsigned threads = 1;
    const std::atomic<bool>* stop = nullptr;  ///< set: what runs is finished, nothing more is begun
};

/// Runs maneuvers 0 to `count` - 1 as `make` gives them; `make` is called on any thread, `done` on one at a time, in the order in which they
/// end. Every result is that of run_in_process with Link::rounded, whatever runs beside it. What a function throws ends the run.
void run_many(const antiskid::can::Layout& layout, std::size_t count, const std::function<Maneuver(std::size_t number)>& make,
              const std::function<void(std::size_t number, const RunResult& result)>& done, const ManyOptions& options);

}  // namespace study
