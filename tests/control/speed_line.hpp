/// A shaft, its frames and the estimator, in a line.
#pragma once

#include <cmath>
#include <numbers>

#include "firmware/control/speed_estimator.hpp"
#include "tests/control/fixed_config.hpp"
#include "tests/control/shaft.hpp"

namespace speed_test {

using namespace antiskid::control;
using control_test::kMillisecond;
using control_test::Shaft;

inline constexpr double kTeeth = 60.0;
inline constexpr double kTooth_rad = 2.0 * std::numbers::pi / kTeeth;

/// One shaft, its frames and the estimator, a frame a period.
struct Line {
    explicit Line(const double period_s = 1e-3) : period(static_cast<std::int64_t>(std::llround(period_s * 1e9))), h(period_s) {}

    SpeedReading turn_to(const double radps) {
        now += period;
        shaft.turn_to(radps, h);
        shaft.report(input, now);
        return estimator.update(input);
    }
    SpeedReading again() {
        now += period;
        return estimator.update(input);
    }

    Time period;
    double h;
    Time now{5'000'000'000};
    Shaft shaft{kTeeth};
    SpeedInput input;
    SpeedEstimator estimator{static_cast<float>(kTeeth)};
};

}  // namespace speed_test
