#include "plant_sim/study/identification/recording.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace identification {

void check(const Recording& recording) {
    if (!(recording.period_s > 0.0)) throw NotIdentifiable(recording.name + ": the control period must be above 0");
    double last_s = std::numeric_limits<double>::lowest();
    for (std::size_t i = 0; i < recording.samples.size(); ++i) {
        const Sample& s = recording.samples[i];
        const bool numbers = std::isfinite(s.time_s) && std::isfinite(s.current_mA) && std::isfinite(s.pressure_Pa) &&
                             std::isfinite(s.wheel.time_s) && std::isfinite(s.flywheel.time_s) && std::isfinite(s.vertical_N) &&
                             std::isfinite(s.longitudinal_N);
        if (!numbers) {
            throw NotIdentifiable(
                fmt::format("{}: sample {} (at {:.3f} s) holds a value that is no number; expected a recording of measured values only",
                            recording.name, i, s.time_s));
        }
        if (s.time_s <= last_s) {
            throw NotIdentifiable(fmt::format("{}: time does not rise at sample {}, {:.6f} s after {:.6f} s", recording.name, i, s.time_s, last_s));
        }
        last_s = s.time_s;
    }
}

}  // namespace identification
