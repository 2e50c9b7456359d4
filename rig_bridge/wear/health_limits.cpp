#include "rig_bridge/wear/health_limits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace wear {

namespace {

std::vector<double> sorted(const std::vector<HealthLimits>& greatest, HealthTest test) {
    std::vector<double> out;
    out.reserve(greatest.size());
    for (const HealthLimits& g : greatest) out.push_back(g.*test);
    std::sort(out.begin(), out.end());
    return out;
}

/// Fits a Gumbel distribution, as maxima have, since the few brakes do not reach far enough; by median and 90 % quantile, so that one odd brake has
/// little effect.
double exceeded_by(const std::vector<double>& rising, double share) {
    const auto n = static_cast<double>(rising.size());
    const double median = rising[static_cast<std::size_t>(0.5 * (n - 1.0))];
    const double ninety = rising[static_cast<std::size_t>(std::ceil(0.9 * (n - 1.0)))];
    const auto reduced = [](double below) { return -std::log(-std::log(below)); };
    return median + (ninety - median) / (reduced(0.9) - reduced(0.5)) * (reduced(1.0 - share) - reduced(0.5));
}

std::size_t rank(const std::vector<double>& rising, double value) {
    return static_cast<std::size_t>(std::lower_bound(rising.begin(), rising.end(), value) - rising.begin());
}

}  // namespace

HealthLimits calibrated(const std::vector<HealthLimits>& greatest) {
    constexpr double kMin = 1.0;  // limit of a stage that no brake reached
    std::array<std::vector<double>, kHealthTests.size()> rising;
    for (std::size_t t = 0; t < rising.size(); ++t) rising.at(t) = sorted(greatest, kHealthTests.at(t));
    const auto flagged = static_cast<std::size_t>(kFalseAlarms * static_cast<double>(greatest.size()));
    HealthLimits out;
    if (flagged == 0) {
        for (std::size_t t = 0; t < rising.size(); ++t)
            out.*kHealthTests.at(t) = std::max(kMin, exceeded_by(rising.at(t), kFalseAlarms / static_cast<double>(rising.size())));
        return out;
    }
    // A brake's measure is its highest rank in any of the tests.
    std::vector<std::size_t> strange;
    strange.reserve(greatest.size());
    for (const HealthLimits& g : greatest) {
        std::size_t highest = 0;
        for (std::size_t t = 0; t < rising.size(); ++t)
            if (g.*kHealthTests.at(t) > 0.0) highest = std::max(highest, rank(rising.at(t), g.*kHealthTests.at(t)));
        strange.push_back(highest);
    }
    std::sort(strange.begin(), strange.end());
    const std::size_t min = strange[strange.size() - flagged];  // rank of the least conspicuous brake that is to be flagged
    for (std::size_t t = 0; t < rising.size(); ++t) out.*kHealthTests.at(t) = std::max(kMin, rising.at(t)[min]);
    return out;
}

}  // namespace wear
