/// Kolmogorov and Smirnov's distance of a sample from a distribution.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace kolmogorov {

template <typename Cumulative>
double distance(std::vector<double> sample, const Cumulative& cumulative) {
    std::sort(sample.begin(), sample.end());
    const auto n = static_cast<double>(sample.size());
    double greatest = 0.0;
    for (std::size_t i = 0; i < sample.size(); ++i) {
        const double f = cumulative(sample[i]);
        greatest = std::max({greatest, f - static_cast<double>(i) / n, static_cast<double>(i + 1) / n - f});
    }
    return greatest;
}

/// What a sample of n from the distribution itself exceeds with a probability of 0.001 (n large).
inline double bound_at_0_001(std::size_t n) {
    return 1.9495 / std::sqrt(static_cast<double>(n));
}

}  // namespace kolmogorov
