#include "rig_bridge/wear/past_lives.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <vector>

namespace wear {

double crossing_J(const MeanCurve& curve, double limit, double step_J, double end_J) {
    double at_J = std::min(curve.last_J(), end_J);
    if (curve(at_J) < limit) {
        while (at_J > curve.first_J() && curve(at_J - step_J) < limit) at_J -= step_J;
        return at_J;
    }
    while (at_J < end_J && curve(at_J) >= limit) at_J += step_J;
    return std::min(at_J, end_J);
}

PastLives::PastLives(const Population& population, double limit) {
    constexpr double kBeyond = 1.1;  // the curve of a brake that was removed at the limit may end slightly above it
    std::vector<double> logs;
    std::size_t crossed = 0;
    for (const MeanCurve& curve : population.members) {
        const double end_J = kBeyond * curve.last_J();
        const double step_J = curve.last_J() / 500.0;
        const double life_J = crossing_J(curve, limit, step_J, end_J);
        crossed += life_J < end_J ? 1 : 0;
        logs.push_back(std::log(std::max(step_J, life_J)));  // a brake that began below the limit has a life of 0
    }
    const auto n = static_cast<double>(logs.size());
    known_ = logs.size() >= 2 && 2 * crossed >= logs.size();
    if (!known_) return;
    for (const double x : logs) log_mean_ += x / n;
    double squares = 0.0;
    for (const double x : logs) squares += (x - log_mean_) * (x - log_mean_);
    constexpr double kMinDeviation = 1e-3;
    freedom_ = n - 1.0;
    log_deviation_ = std::max(kMinDeviation, std::sqrt(squares / freedom_ * (1.0 + 1.0 / n)));
}

double PastLives::life_J(double c_e_J, double share) const {
    const boost::math::students_t t(freedom_);
    constexpr double kMinLeft = 1e-9;  // for a brake that has outlived all others
    const double longer = c_e_J <= 0.0 ? 1.0 : std::max(kMinLeft, cdf(complement(t, (std::log(c_e_J) - log_mean_) / log_deviation_)));
    return std::max(c_e_J, std::exp(log_mean_ + log_deviation_ * quantile(complement(t, longer * (1.0 - share)))));
}

}  // namespace wear
