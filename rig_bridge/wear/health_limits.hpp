/// Limits of the health tests from healthy brakes, set so that all tests together call a share kFalseAlarms of them abnormal in their whole lives.
#pragma once

#include <vector>

#include "rig_bridge/wear/population.hpp"

namespace wear {

inline constexpr double kFalseAlarms = 0.01;

/// `greatest`: HealthMonitor::greatest() of each of several healthy brakes, at least one, after its whole life. With at least 100 brakes, each test's
/// limit is exceeded by the same number of them, and kFalseAlarms of them exceed any. Fewer do not show that rate: limits then follow from Gumbel's
/// distribution of maxima, with equal shares of the rate per test.
[[nodiscard]] HealthLimits calibrated(const std::vector<HealthLimits>& greatest);

}  // namespace wear
