/// Limits of the health tests from what healthy brakes reach: all tests together call a share kFalseAlarms of them abnormal in their whole lives.
#pragma once

#include <vector>

#include "rig_bridge/wear/population.hpp"

namespace wear {

inline constexpr double kFalseAlarms = 0.01;

/// `greatest`: HealthMonitor::greatest() of each of several healthy brakes, at least one, after its whole life. Of 100 and more, each test gets
/// the limit that the same number of brakes exceeds, so that kFalseAlarms of them exceed any. Fewer do not show that rate: theirs is taken from
/// Gumbel's distribution of maxima, an equal part of it for each test.
[[nodiscard]] HealthLimits calibrated(const std::vector<HealthLimits>& greatest);

}  // namespace wear
