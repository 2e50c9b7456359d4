#include "plant_sim/lab/in_team.hpp"
#include "rig_bridge/wear/on_threads.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>

namespace plant_sim::lab {

int in_team(const std::function<int(study::team::Team& team)>& work) {
    const std::unique_ptr<study::team::Team> team = study::team::join_team();
    try {
        return work(*team);
    } catch (const std::exception& e) {
        if (team->size() == 1) throw;
        // The others would wait for this one for ever.
        fmt::print(stderr, "rig-lab: process {}: {}\n", team->rank(), e.what());
        team->end_all(2);
        return 2;
    }
}

unsigned threads_in(const study::team::Team& team, unsigned asked) {
    if (asked > 0) return asked;
    // mpirun is told how many processes there shall be: one thread each, unless more are asked for.
    return team.size() > 1 ? 1 : wear::all_cores();
}

}  // namespace plant_sim::lab
