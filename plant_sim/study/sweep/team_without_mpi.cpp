#include <stdexcept>

#include "plant_sim/study/sweep/team_alone.hpp"

namespace sweep {

std::unique_ptr<Team> join_team() {
    if (started_by_mpirun() > 1)
        throw std::runtime_error(
            "mpirun started several processes, but this program was built where MPI was not installed "
            "(libopenmpi-dev): each would run the whole sweep. Use --shard I/N instead.");
    return std::make_unique<Alone>();
}

}  // namespace sweep
