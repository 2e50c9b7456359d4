#include "rig_bridge/wear/health_limits.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace wear {

namespace {

std::vector<double> sorted(const std::vector<HealthLimits>& greatest, double HealthLimits::*test) {
    std::vector<double> out;
    out.reserve(greatest.size());
    for (const HealthLimits& g : greatest) out.push_back(g.*test);
    std::sort(out.begin(), out.end());
    return out;
}

/// Maxima are distributed as Gumbel found, which reaches beyond what few brakes show; by median and 90 %, so that one odd brake does not decide.
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
    const std::vector<double> gradual = sorted(greatest, &HealthLimits::gradual);
    const std::vector<double> sudden = sorted(greatest, &HealthLimits::sudden);
    const auto flagged = static_cast<std::size_t>(kFalseAlarms * static_cast<double>(greatest.size()));
    if (flagged == 0) return {exceeded_by(gradual, 0.5 * kFalseAlarms), exceeded_by(sudden, 0.5 * kFalseAlarms)};
    // The higher of a brake's ranks in the two tests says how strange it is.
    std::vector<std::size_t> strange;
    strange.reserve(greatest.size());
    for (const HealthLimits& g : greatest) strange.push_back(std::max(rank(gradual, g.gradual), rank(sudden, g.sudden)));
    std::sort(strange.begin(), strange.end());
    const std::size_t min = strange[strange.size() - flagged];  // rank of the least strange one to be flagged
    return {gradual[min], sudden[min]};
}

}  // namespace wear
