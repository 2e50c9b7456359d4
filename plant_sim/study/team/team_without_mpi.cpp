#include <stdexcept>

#include "plant_sim/study/team/team.hpp"

namespace study::team {

std::unique_ptr<Team> join_team() {
    if (started_by_mpirun() > 1)
        throw std::runtime_error(
            "mpirun started several processes, but this program was built where MPI was not installed (libopenmpi-dev): each would do all of the "
            "work.");
    return std::make_unique<SingleProcess>();
}

}  // namespace study::team
