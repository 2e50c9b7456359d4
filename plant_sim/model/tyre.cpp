#include "plant_sim/model/tyre.hpp"

#include <algorithm>

namespace plant {

Peak peak(const Surface& surface) {
    const double slope_ratio =
        surface.c1 * surface.c2 / surface.c3;  // infinite for c3 = 0, then the clamp holds
    const double slip = std::clamp(std::log(slope_ratio) / surface.c2, 0.0, 1.0);
    return {slip, friction(surface, slip).mu};
}

}  // namespace plant
