#include "plant_sim/model/drag.hpp"

#include <cmath>

namespace plant {

CoastDown coast_down(const Drag& drag, double mass_kg, double v_mps, double seconds) {
    const double ratio = std::sqrt(drag.windage_Ns2pm2 / drag.bearing_N);
    const double rate = std::sqrt(drag.windage_Ns2pm2 * drag.bearing_N) / mass_kg;
    const double left = std::atan(v_mps * ratio) - seconds * rate;
    const double v = left > 0.0 ? std::tan(left) / ratio : 0.0;
    return {v, 0.5 * mass_kg / drag.windage_Ns2pm2 * std::log(drag.force_N(v_mps) / drag.force_N(v))};
}

}  // namespace plant
