#include "rig_bridge/wear/landings_forecast.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <utility>
#include <vector>

namespace wear {

namespace {

constexpr double kLifeAhead = 0.05;  // of a life
constexpr double kKept = 0.985;      // of the misfit, from one maneuver to the next
constexpr double kMaxSquare = 25.0;

double median_end_J(const Population& population) {
    std::vector<double> ends_J;
    ends_J.reserve(population.members.size());
    for (const MeanCurve& curve : population.members) ends_J.push_back(curve.last_J());
    const auto middle = ends_J.begin() + static_cast<std::ptrdiff_t>(ends_J.size() / 2);
    std::nth_element(ends_J.begin(), middle, ends_J.end());
    return *middle;
}

}  // namespace

LandingsForecast::LandingsForecast(const Population& population)
    : population_(&population), filter_(population), reach_J_(kLifeAhead * median_end_J(population)) {}

LandingsForecast::Expected LandingsForecast::expected_at(double c_e_J) const {
    double mean = 0.0;
    double squares = 0.0;
    for (const BrakeFilter::Hypothesis& h : filter_.hypotheses()) {
        const double m = filter_.mean_friction(h, c_e_J);
        mean += h.weight * m;
        squares += h.weight * m * m;
    }
    const Scatter& s = population_->scatter;
    const double variance = std::max(0.0, squares - mean * mean) + filter_.offset_variance() +
                            s.drift_per_root_MJ * s.drift_per_root_MJ * (c_e_J - c_e_J_) * 1e-6 + s.remembered * s.remembered + s.fresh * s.fresh;
    return {c_e_J, mean, variance};
}

void LandingsForecast::learn(const Point& point) {
    for (; !waiting_.empty() && waiting_.front().at_J <= point.c_e_J; waiting_.pop_front()) {
        const double off = point.mean_friction - waiting_.front().mean;
        misfit_ = kKept * misfit_ + (1.0 - kKept) * std::min(kMaxSquare, off * off / waiting_.front().variance);
    }
    filter_.learn(point);
    c_e_J_ = point.c_e_J;
    waiting_.push_back(expected_at(c_e_J_ + reach_J_));
}

double LandingsForecast::population_probability() const {
    const ForecastCalibration& c = population_->calibration;
    if (c.misfit_deviation <= 0.0) return 1.0;
    constexpr double kPrior = 0.8;
    constexpr double kOtherwise = 0.25;  // density of the logarithm for other brakes: up to 50 times the mean
    const boost::math::students_t t(std::max(2.0, static_cast<double>(population_->members.size()) - 1.0));
    const double off = std::max(0.0, (std::log(misfit_) - c.log_misfit) / c.misfit_deviation);
    const double of_kind = kPrior * pdf(t, off) / c.misfit_deviation;
    return of_kind / (of_kind + (1.0 - kPrior) * kOtherwise);
}

Forecast LandingsForecast::forecast(const LandingMix& mix, const ForecastSettings& settings) const {
    Forecast out = wear::forecast(filter_, c_e_J_, mix, settings);
    const PastLives past(*population_, settings.limit);
    if (!past.known()) return out;
    out.population_probability = population_probability();
    double landing_J = 0.0;
    for (const LandingKind& kind : mix) landing_J += kind.share * kind.energy_J;
    std::vector<double> lives_J = past_lives_J(past, c_e_J_, out.energies_J.size());
    std::vector<double> lives = lives_J;
    for (double& n : lives) n = std::ceil((n - c_e_J_) / landing_J);
    const double share = share_of_life(c_e_J_, out.energies_J, lives_J);
    const Correction correction{ForecastCalibration::at(population_->calibration.filter, share), out.population_probability,
                                ForecastCalibration::at(population_->calibration.widening, share)};
    out.energies_J = corrected(std::move(out.energies_J), std::move(lives_J), c_e_J_, correction);
    out.landings = corrected(std::move(out.landings), std::move(lives), 0.0, correction);
    for (double& n : out.landings) n = std::round(n);
    take_quantiles(out);
    return out;
}

std::vector<double> past_lives_J(const PastLives& past, double c_e_J, std::size_t count) {
    std::vector<double> out(count);
    for (std::size_t i = 0; i < count; ++i) out[i] = past.life_J(c_e_J, (static_cast<double>(i) + 0.5) / static_cast<double>(count));
    return out;
}

double share_of_life(double c_e_J, const std::vector<double>& filter_J, const std::vector<double>& lives_J) {
    const std::size_t middle = lives_J.size() / 2;
    return c_e_J / (0.5 * (std::min(filter_J[middle], lives_J.back()) + lives_J[middle]));
}

std::vector<double> corrected(std::vector<double> filter, std::vector<double> lives, double now, const Correction& c) {
    const std::size_t n = filter.size();
    // Lifetimes that no past brake is likely to have had are excluded: a filter that diverges is far off.
    for (double& x : filter) x = std::clamp(x, lives.front(), lives.back());
    for (std::size_t i = 0; i < n; ++i) filter[i] = c.filter * filter[i] + (1.0 - c.filter) * lives[i];
    std::vector<std::pair<double, double>> pool;
    pool.reserve(2 * n);
    for (const double x : filter) pool.emplace_back(x, c.population_probability);
    for (const double x : lives) pool.emplace_back(x, 1.0 - c.population_probability);
    std::sort(pool.begin(), pool.end());
    double below = 0.0;
    std::size_t i = 0;
    for (const auto& [x, weight] : pool) {
        below += weight;
        for (; i < n && static_cast<double>(i) + 0.5 <= below; ++i) filter[i] = x;
    }
    for (; i < n; ++i) filter[i] = pool.back().first;
    // For brakes of another kind no correction is known.
    const double factor = 1.0 + c.population_probability * (c.widening - 1.0);
    const double median = filter[n / 2];
    for (double& x : filter) x = std::max(now, median + factor * (x - median));
    return filter;
}

}  // namespace wear
