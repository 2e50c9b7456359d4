/// A sweep by all threads of all processes of a team; what is finished is kept as it comes.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <vector>

#include "plant_sim/study/sweep/stops_table.hpp"
#include "plant_sim/study/team/team.hpp"

namespace sweep {

struct Work {
    std::filesystem::path part{};             ///< the leader's PartFile: what it holds is not run again
    unsigned threads = 1;                     ///< of each process
    const std::atomic<bool>* stop = nullptr;  ///< see RunOptions
    /// By the leader, for each stop that is finished: how many are, of how many, and how many were before this run.
    std::function<void(std::size_t done, std::size_t all, std::size_t before)> progress{};
};

/// For the leader: the stops that are finished, by number; all of them unless it was stopped. Nothing for the others. Every
/// process must be given the same plan: one that was not throws std::invalid_argument. Otherwise as PartFile and run().
[[nodiscard]] std::vector<Row> run_together(const SweepPlan& plan, const Work& work, study::team::Team& team);

}  // namespace sweep
