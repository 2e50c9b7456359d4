/// Distributes numbered pieces of work over the processes of a team; the leader gets all results.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plant_sim/study/team/team.hpp"

namespace study::team {

/// Numbers 0 to `pieces` - 1 in the order of work, always the same: mixed, so that long pieces (stops on ice) and short ones spread evenly over
/// threads and processes, and the remaining time can be estimated from the share done.
[[nodiscard]] std::vector<std::size_t> order_of_work(std::size_t pieces);

/// This process's share of `pending`, which must be the same in every process.
[[nodiscard]] std::vector<std::size_t> share_of(std::span<const std::size_t> pending, const Team& team);

/// Takes the result of one piece, as a text that is not empty. May be called by any thread, one at a time.
using PieceDone = std::function<void(const std::string& piece)>;

/// Call in every process of the team. `work` does this process's share; in the leader, `take` is called with each result of another process, one at a
/// time. Returns when all shares are done. An exception of `work` or `take` is passed on; the other processes would wait.
void work_together(Team& team, const std::function<void(const PieceDone&)>& work, const std::function<void(std::string_view piece)>& take);

}  // namespace study::team
