#include "rig_bridge/wear/life_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "rig_bridge/wear/draw.hpp"
#include "rig_bridge/wear/life_kalman.hpp"

namespace wear {

namespace {

constexpr double kGridReach = 4.0;  // standard deviations of log L

double squared(double x) {
    return x * x;
}

/// Share of life from which on a curve is below the limit; infinite: not within two lives.
double crossing(const life::Values& curve, double limit) {
    Eigen::Index k = life::kKnots - 1;
    if (curve(k) >= limit) {
        const double slope = (curve(k) - curve(k - 1)) / (kLifeKnots.back() - kLifeKnots.at(kCurve - 2));
        const double share = kLifeKnots.back() + (limit - curve(k)) / slope;
        return slope < 0.0 && share < 2.0 ? share : std::numeric_limits<double>::infinity();
    }
    while (k > 0 && curve(k - 1) < limit) --k;
    if (k == 0) return 0.0;
    const auto i = static_cast<std::size_t>(k);
    return kLifeKnots.at(i - 1) + (kLifeKnots.at(i) - kLifeKnots.at(i - 1)) * (curve(k - 1) - limit) / (curve(k - 1) - curve(k));
}

}  // namespace

LifeFilter::LifeFilter(const LifeCurves& curves, int grid) : curves_(&curves) {
    const double freedom = static_cast<double>(curves.lives) - 1.0;
    const double deviation = std::sqrt(1.0 + 1.0 / static_cast<double>(curves.lives));
    hypotheses_.reserve(static_cast<std::size_t>(grid));
    for (int i = 0; i < grid; ++i) {
        const double t = kGridReach * (2.0 * i / (grid - 1) - 1.0);
        const double deviations = deviation * t;
        add(std::exp(curves.log_life + curves.log_life_deviation * deviations), deviations, -0.5 * (freedom + 1.0) * std::log1p(t * t / freedom));
    }
}

LifeFilter LifeFilter::of_life(const LifeCurves& curves, double life_J) {
    LifeFilter out;
    out.curves_ = &curves;
    out.add(life_J, (std::log(life_J) - curves.log_life) / curves.log_life_deviation, 0.0);
    return out;
}

void LifeFilter::add(double life_J, double deviations, double log_prior) {
    Hypothesis h{life_J, log_prior, 0.0, 0.0, {}, {}};
    for (std::size_t k = 0; k < kCurve; ++k) h.state.at(k) = curves_->mean.at(k) + deviations * curves_->by_life.at(k);
    h.state.at(life::kSlope) = curves_->lining.slope + deviations * curves_->lining.by_life;
    Eigen::Map<life::Covariance>(h.covariance.data()) = life::prior(*curves_);
    hypotheses_.push_back(h);
}

double LifeFilter::of_energies() const {
    return life::of(curves_->energy, energies_);
}

LifeFilter::Predicted LifeFilter::predicted(const Hypothesis& h) const {
    const KnotPlace place = knot_place(taken_J_ / h.life_J);
    const Eigen::Map<const life::Covariance> covariance(h.covariance.data());
    return {life::seen(Eigen::Map<const life::State>(h.state.data()), place) + of_energies(),
            life::seen(life::seen_of(covariance, place), place) + squared(curves_->fresh)};
}

void LifeFilter::learn(const Point& point) {
    const double friction = point.mean_friction - of_energies();
    for (Hypothesis& h : hypotheses_) {
        Eigen::Map<life::State> state(h.state.data());
        Eigen::Map<life::Covariance> covariance(h.covariance.data());
        const life::Innovation i = life::update(state, covariance, knot_place(taken_J_ / h.life_J), friction, *curves_);
        h.log_likelihood -= 0.5 * (i.off * i.off / i.variance + std::log(i.variance));
    }
    // Where a brake comes with energy that was taken before, the first maneuver's own is not known.
    const double energy_J = point.c_e_J - taken_J_;
    constexpr double kMax = 3.0;
    life::come(energies_, begun_ || energy_J < kMax * curves_->landing_J ? std::min(kMax, energy_J / curves_->landing_J) - 1.0 : 0.0);
    taken_J_ = point.c_e_J;
    begun_ = true;
}

void LifeFilter::read(const LiningReading& reading) {
    if (curves_->lining.lives == 0) return;
    for (Hypothesis& h : hypotheses_) {
        Eigen::Map<life::State> state(h.state.data());
        Eigen::Map<life::Covariance> covariance(h.covariance.data());
        const life::Innovation i = life::read(state, covariance, reading.c_e_J / h.life_J, reading.worn, *curves_);
        h.log_readings -= 0.5 * (i.off * i.off / i.variance + std::log(i.variance));
    }
}

std::vector<LifeFilter::Life> LifeFilter::lives() const {
    double greatest = -std::numeric_limits<double>::infinity();
    const auto log_weight = [&](const Hypothesis& h) {
        return h.log_prior + curves_->evidence * h.log_likelihood + curves_->lining.evidence * h.log_readings;
    };
    for (const Hypothesis& h : hypotheses_) greatest = std::max(greatest, log_weight(h));
    std::vector<Life> out;
    out.reserve(hypotheses_.size());
    double sum = 0.0;
    for (const Hypothesis& h : hypotheses_) {
        out.push_back({h.life_J, std::exp(log_weight(h) - greatest)});
        sum += out.back().weight;
    }
    for (Life& l : out) l.weight /= sum;
    return out;
}

std::vector<double> LifeFilter::lives_J(std::size_t count) const {
    const std::vector<Life> all = lives();
    std::vector<double> out(count, all.back().life_J);
    double below = 0.0;  // up to half of the weight of life `i`
    std::size_t i = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const double share = (static_cast<double>(k) + 0.5) / static_cast<double>(count);
        const auto step = [&] { return 0.5 * (all[i].weight + all[i + 1].weight); };
        if (k == 0) below = 0.5 * all.front().weight;
        for (; i + 1 < all.size() && below + step() <= share; ++i) below += step();
        if (i + 1 == all.size()) break;
        out[k] = all[i].life_J + std::max(0.0, share - below) / step() * (all[i + 1].life_J - all[i].life_J);
    }
    return out;
}

std::vector<double> LifeFilter::ends_J(double limit, std::size_t count, std::uint64_t seed) const {
    std::vector<double> out = lives_J(count);
    if (limit == curves_->limit) return out;
    for (std::size_t i = 0; i < count; ++i) {
        // Of the grid's lives the nearest says what curve this one has.
        const auto near = std::min_element(hypotheses_.begin(), hypotheses_.end(), [&](const Hypothesis& a, const Hypothesis& b) {
            return std::abs(a.life_J - out[i]) < std::abs(b.life_J - out[i]);
        });
        Generator generator = generator_of(seed, i);
        life::Values z;
        for (Eigen::Index k = 0; k < life::kKnots; ++k) z(k) = normal(generator);
        const life::ValuesCovariance covariance =
            Eigen::Map<const life::Covariance>(near->covariance.data()).topLeftCorner<life::kKnots, life::kKnots>();
        const life::Values curve =
            Eigen::Map<const life::State>(near->state.data()).head<life::kKnots>() + life::Values(covariance.llt().matrixL() * z);
        out[i] *= crossing(curve, limit);
    }
    std::sort(out.begin(), out.end());
    return out;
}

Expectation LifeFilter::expected() const {
    const std::vector<Life> all = lives();
    double mean = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Predicted p = predicted(hypotheses_[i]);
        mean += all[i].weight * p.mean;
        squares += all[i].weight * (p.variance + p.mean * p.mean);
    }
    return {mean, std::sqrt(squares - mean * mean)};
}

double LifeFilter::log_density(double friction) const {
    const std::vector<Life> all = lives();
    double sum = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Predicted p = predicted(hypotheses_[i]);
        sum += all[i].weight * std::exp(-0.5 * squared(friction - p.mean) / p.variance) / std::sqrt(2.0 * std::numbers::pi * p.variance);
    }
    return std::log(std::max(sum, std::numeric_limits<double>::min()));
}

}  // namespace wear
