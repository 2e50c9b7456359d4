/// Brake pressure transducer: range, noise, resolution.
#pragma once

#include <algorithm>
#include <cmath>

#include "plant_sim/model/random.hpp"

namespace plant {

struct TransducerParameters {
    double range_Pa = 0.0;       ///< reads 0 to range
    double noise_Pa = 0.0;       ///< standard deviation
    double resolution_Pa = 0.0;  ///< of its converter; 0: continuous
};

inline double reading_Pa(const TransducerParameters& transducer, double pressure_Pa, Random& random) {
    double reading = pressure_Pa + transducer.noise_Pa * random.noise();
    if (transducer.resolution_Pa > 0.0)
        reading = transducer.resolution_Pa * std::nearbyint(reading / transducer.resolution_Pa);
    return std::clamp(reading, 0.0, transducer.range_Pa);
}

}  // namespace plant
