/// Inside the sweep: what Section VI and Fig. 13 and 14 say, as demands on the means.
#pragma once

#include "plant_sim/study/sweep/summary.hpp"

namespace sweep {

/// Fills `checks` and `unchecked` from the means.
void check(Summary& summary);

}  // namespace sweep
