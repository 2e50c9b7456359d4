/// Order statistics.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace study {

/// Percentile by nearest rank: the smallest element of `sorted` that `percent` % of the elements do not exceed. `sorted`: ascending, not empty;
/// `percent`: 1 to 100.
[[nodiscard]] inline double percentile(const std::vector<double>& sorted, std::size_t percent) {
    return sorted[(sorted.size() * percent + 99) / 100 - 1];
}

/// The upper one of two middle values; 0 without values.
[[nodiscard]] inline double median(std::vector<double> values) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Standard deviation of normally distributed errors from their absolute values; hardly changed by outliers.
[[nodiscard]] inline double deviation_by_median(std::vector<double> absolute) {
    constexpr double kMedianOfNormal = 0.6745;
    return median(std::move(absolute)) / kMedianOfNormal;
}

}  // namespace study
