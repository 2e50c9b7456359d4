/// How far a computation of counted steps is, on standard error: a bar on a terminal, a line each tenth elsewhere.
#pragma once

#include <cstddef>

namespace plant_sim {

/// After step `done` of `all`, both at least 1; `what` names the steps.
void show_steps(std::size_t done, std::size_t all, const char* what);

}  // namespace plant_sim
