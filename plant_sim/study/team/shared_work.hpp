/// Numbered pieces of work, shared by the processes of a team; the leader gets what all of them finish.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plant_sim/study/team/team.hpp"

namespace study::team {

/// Numbers 0 to `pieces` - 1 in the order of work: mixed, so that long ones (stops on ice) and short ones fall evenly to threads and
/// processes, and time left follows from the share done. Always the same.
[[nodiscard]] std::vector<std::size_t> order_of_work(std::size_t pieces);

/// What of `pending`, the same in every process, falls to this one.
[[nodiscard]] std::vector<std::size_t> share_of(std::span<const std::size_t> pending, const Team& team);

/// To be given each finished piece of this process as a text that is not empty, one at a time, by any thread.
using HandIn = std::function<void(const std::string& piece)>;

/// Every process of the team calls it: `work` does this process's share, and `take` is called in the leader with each piece that a process
/// hands in, one at a time. Returns when all shares are done. What `work` or `take` throws comes out of it; the others would wait.
void work_together(Team& team, const std::function<void(const HandIn&)>& work, const std::function<void(std::string_view piece)>& take);

}  // namespace study::team
