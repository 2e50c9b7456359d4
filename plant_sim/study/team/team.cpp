#include <charconv>
#include <cstring>

#include "plant_sim/study/team/team.hpp"

namespace study::team {

std::size_t started_by_mpirun() {
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}) {
        const char* text = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nobody sets variables
        std::size_t processes = 0;
        if (text != nullptr && std::from_chars(text, text + std::strlen(text), processes).ec == std::errc()) return processes;
    }
    return 1;
}

}  // namespace study::team
