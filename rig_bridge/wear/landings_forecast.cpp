#include "rig_bridge/wear/landings_forecast.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace wear {

namespace {

constexpr double kChange = 0.001;   // of beginning to behave otherwise, with each maneuver [A]
constexpr double kMinAlike = 1e-6;  // so that evidence can still bring it back

}  // namespace

LandingsForecast::LandingsForecast(const Population& population)
    : population_(&population), filter_(population), lining_(population.curves, kOtherLining) {
    if (population.curves.lives > 0) life_.emplace(population.curves);
}

void LandingsForecast::learn(const Point& point) {
    filter_.learn(point);
    c_e_J_ = point.c_e_J;
    if (!life_) return;
    const LifeCurves& c = population_->curves;
    const double noise2 = c.noise * c.noise;
    alike_ = std::max(kMinAlike, (1.0 - kChange) * alike_);
    if (begun_) {
        const double variance = level_variance_ + noise2, off = point.mean_friction - level_;
        const double otherwise = std::exp(-0.5 * off * off / variance) / std::sqrt(2.0 * std::numbers::pi * variance);
        constexpr double kMin = 1e-3;  // both may be far off, and neither is right then
        const double of_kind = std::exp(life_->log_density(point.mean_friction));
        alike_ = alike_ * (of_kind + kMin) / (alike_ * (of_kind + kMin) + (1.0 - alike_) * (otherwise + kMin));
        level_ += level_variance_ / variance * off;
        level_variance_ *= noise2 / variance;
    } else {
        level_ = point.mean_friction;
        level_variance_ = noise2;
        begun_ = true;
    }
    level_variance_ += c.walk * c.walk;
    life_->learn(point);
}

void LandingsForecast::read(const LiningReading& reading) {
    if (!life_ || population_->curves.lining.lives == 0) return;
    life_->read(reading);
    lining_.read(reading);
}

void LandingsForecast::learn(const Campaign& campaign, std::size_t from) {
    auto reading = campaign.readings.begin();
    for (std::size_t i = from; i < campaign.points.size(); ++i) {
        learn(campaign.points[i]);
        for (; reading != campaign.readings.end() && reading->c_e_J <= campaign.points[i].c_e_J; ++reading) read(*reading);
    }
    for (; reading != campaign.readings.end(); ++reading) read(*reading);
    c_e_J_ = std::max(c_e_J_, campaign.taken_J);
}

Conditional LandingsForecast::next() const {
    if (!life_) {
        const Expectation e = filter_.expected(c_e_J_);
        return {{{1.0, e.mean, e.deviation * e.deviation}}};
    }
    const Expectation e = life_->expected();
    const double noise = population_->curves.noise, alike = (1.0 - kChange) * alike_;
    return {{{alike, e.mean, e.deviation * e.deviation}, {1.0 - alike, level_, level_variance_ + noise * noise}}};
}

Forecast LandingsForecast::forecast(const LandingMix& mix, const ForecastSettings& settings) const {
    Forecast out = wear::forecast(filter_, c_e_J_, mix, settings);
    if (!life_) return out;
    const auto count = static_cast<std::size_t>(settings.draws);
    std::vector<double> ends_J = life_->ends_J(settings.limit, count, settings.seed);
    if (const PastLives past(*population_, settings.limit); past.known()) {
        out.population_probability = alike_;
        const std::vector<double> lives_J = past_lives_J(past, lining_, c_e_J_, out.crossed_now, count);
        // What no brake is likely to have lasted, this one does not last either: a filter that goes astray goes far.
        for (double& end_J : ends_J) end_J = std::min(end_J, lives_J.back());
        ends_J = pooled(ends_J, lives_J, alike_);
    }
    double crossed = 0.0, ever = 0.0;
    out.landings.clear();
    out.energies_J.clear();
    for (std::size_t i = 0; i < count; ++i) {
        Generator generator = generator_of(settings.seed, i);
        const double landings = landings_until(ends_J[i], c_e_J_, mix, settings.horizon, generator);
        out.landings.push_back(landings);
        out.energies_J.push_back(std::isfinite(landings) ? std::max(c_e_J_, ends_J[i]) : landings);
        crossed += landings <= 0.0 ? 1.0 : 0.0;
        ever += std::isfinite(landings) ? 1.0 : 0.0;
    }
    std::sort(out.landings.begin(), out.landings.end());
    std::sort(out.energies_J.begin(), out.energies_J.end());
    out.crossed_now = crossed / settings.draws;
    out.crossed_ever = ever / settings.draws;
    take_quantiles(out);
    return out;
}

std::vector<double> past_lives_J(const PastLives& past, const LiningLikelihood& lining, double c_e_J, double crossed, std::size_t count) {
    const auto share = [](std::size_t i, std::size_t of) { return (static_cast<double>(i) + 0.5) / static_cast<double>(of); };
    std::vector<double> read;
    if (lining.any()) {
        constexpr std::size_t kFiner = 20;
        std::vector<double> lives_J(kFiner * count);
        for (std::size_t i = 0; i < lives_J.size(); ++i) lives_J[i] = past.life_J(c_e_J, share(i, lives_J.size()));
        read = lining.given(lives_J, count);
    }
    std::vector<double> out(count, c_e_J);
    for (std::size_t i = 0; i < count; ++i) {
        const double left = (share(i, count) - crossed) / (1.0 - crossed);
        if (share(i, count) > crossed)
            out[i] = read.empty() ? past.life_J(c_e_J, left) : read[static_cast<std::size_t>(left * static_cast<double>(count))];
    }
    return out;
}

std::vector<double> pooled(const std::vector<double>& first, const std::vector<double>& second, double share) {
    std::vector<std::pair<double, double>> pool;
    pool.reserve(first.size() + second.size());
    for (const double x : first) pool.emplace_back(x, share);
    for (const double x : second) pool.emplace_back(x, 1.0 - share);
    std::sort(pool.begin(), pool.end());
    std::vector<double> out;
    out.reserve(first.size());
    double below = 0.0;
    for (const auto& [x, weight] : pool) {
        below += weight;
        while (out.size() < first.size() && static_cast<double>(out.size()) + 0.5 <= below) out.push_back(x);
    }
    out.resize(first.size(), pool.back().first);
    return out;
}

}  // namespace wear
