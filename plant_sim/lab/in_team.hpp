/// Verbs that the processes of mpirun work on together.
#pragma once

#include <functional>

#include "plant_sim/study/team/team.hpp"

namespace plant_sim::lab {

/// `work` in this process of the team that mpirun started, or alone; its exit status. What it throws ends all processes.
[[nodiscard]] int in_team(const std::function<int(study::team::Team& team)>& work);

/// Threads of this process where `asked` were asked for, 0 for no wish.
[[nodiscard]] unsigned threads_in(const study::team::Team& team, unsigned asked);

}  // namespace plant_sim::lab
