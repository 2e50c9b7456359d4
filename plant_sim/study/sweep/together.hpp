/// A sweep by all threads of all processes of a team; finished stops are stored as they come.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <vector>

#include "plant_sim/study/sweep/stops_table.hpp"
#include "plant_sim/study/team/team.hpp"

namespace sweep {

struct Work {
    std::filesystem::path part{};             ///< the leader's PartFile; its stops are not run again
    unsigned threads = 1;                     ///< of each process
    const std::atomic<bool>* stop = nullptr;  ///< see RunOptions
    /// Called by the leader for each finished stop, with the number of finished ones, of all, and of those from an earlier run.
    std::function<void(std::size_t done, std::size_t all, std::size_t before)> progress{};
};

/// Returns to the leader the finished stops by number (all, unless stopped), to the others nothing. Every process must have the same plan; one that
/// has not throws std::invalid_argument. Otherwise as PartFile and run().
[[nodiscard]] std::vector<SweptStop> run_together(const SweepPlan& plan, const Work& work, study::team::Team& team);

}  // namespace sweep
