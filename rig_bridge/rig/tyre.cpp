#include "rig_bridge/rig/tyre.hpp"

#include <algorithm>

namespace rig {

Peak peak(const FrictionLaw& law) {
    const double slope_ratio = law.c1 * law.c2 / law.c3;  // infinite for c3 = 0, and limited by the clamp
    const double slip = std::clamp(std::log(slope_ratio) / law.c2, 0.0, 1.0);
    return {slip, friction(law, slip).mu};
}

Peak peak(const Surface& surface, double v_mps) {
    Peak at = peak(surface);
    if (surface.wet) at.mu = surface.wet->at(v_mps).mu;
    return at;
}

}  // namespace rig
