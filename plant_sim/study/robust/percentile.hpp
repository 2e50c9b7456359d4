/// Order statistics.
#pragma once

#include <cstddef>
#include <vector>

namespace robust {

/// Nearest rank: the least of `sorted`, ascending and not empty, that `percent` of them, 1 to 100, do not exceed.
[[nodiscard]] inline double percentile(const std::vector<double>& sorted, std::size_t percent) {
    return sorted[(sorted.size() * percent + 99) / 100 - 1];
}

}  // namespace robust
