/// Brake pressure transducer: range, noise, resolution.
#pragma once

#include <algorithm>
#include <cmath>

#include "rig_bridge/rig/random.hpp"
#include "rig_bridge/rig/rig_parameters.hpp"

namespace plant {

inline double reading_Pa(const TransducerParameters& transducer, double pressure_Pa, Random& random) {
    double reading = pressure_Pa + transducer.noise_Pa * random.noise();
    if (transducer.resolution_Pa > 0.0)
        reading = transducer.resolution_Pa * std::nearbyint(reading / transducer.resolution_Pa);
    return std::clamp(reading, 0.0, transducer.range_Pa);
}

}  // namespace plant
