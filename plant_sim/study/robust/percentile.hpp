/// Order statistics.
#pragma once

#include <cstddef>
#include <vector>

namespace robust {

/// Percentile by nearest rank: the smallest element of `sorted` that `percent` % of the elements do not exceed. `sorted`: ascending, not empty;
/// `percent`: 1 to 100.
[[nodiscard]] inline double percentile(const std::vector<double>& sorted, std::size_t percent) {
    return sorted[(sorted.size() * percent + 99) / 100 - 1];
}

}  // namespace robust
