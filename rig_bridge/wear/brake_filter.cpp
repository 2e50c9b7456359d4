#include "rig_bridge/wear/brake_filter.hpp"

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <numbers>

namespace wear {

namespace {

constexpr int kScales = 15;
constexpr double kReach = 2.5;  // range of the grid in standard deviations of log s
constexpr double kMax = 8.0;

double square(double x) {
    return x * x;
}

}  // namespace

BrakeFilter::BrakeFilter(const Population& population)
    : population_(&population), variance_offset_(square(population.spread.offset)), variance_remembered_(square(population.scatter.remembered)) {
    const int scales = population.spread.log_energy_scale > 0.0 ? kScales : 1;
    hypotheses_.reserve(population.members.size() * static_cast<std::size_t>(scales));
    double sum = 0.0;
    for (std::size_t k = 0; k < population.members.size(); ++k) {
        for (int i = 0; i < scales; ++i) {
            const double z = scales == 1 ? 0.0 : kReach * (2.0 * i / (scales - 1) - 1.0);
            hypotheses_.push_back({k, std::exp(z * population.spread.log_energy_scale), std::exp(-0.5 * z * z), 0.0, 0.0, 0.0});
            sum += hypotheses_.back().weight;
        }
    }
    for (Hypothesis& h : hypotheses_) h.prior = h.weight /= sum;
}

double BrakeFilter::mean_friction(const Hypothesis& hypothesis, double c_e_J) const {
    return population_->members[hypothesis.member](c_e_J / hypothesis.energy_scale) + hypothesis.offset;
}

double BrakeFilter::predicted(const Hypothesis& hypothesis, double c_e_J) const {
    return mean_friction(hypothesis, c_e_J) + population_->scatter.memory * hypothesis.remembered;
}

BrakeFilter::Ahead BrakeFilter::ahead(double c_e_J) const {
    const Scatter& s = population_->scatter;
    const double passed_MJ = begun_ ? std::max(0.0, c_e_J - c_e_J_) * 1e-6 : 0.0;
    Ahead a{};
    a.offset = variance_offset_ + square(s.drift_per_root_MJ) * passed_MJ;
    a.remembered = square(s.memory) * variance_remembered_ + (1.0 - square(s.memory)) * square(s.remembered);
    a.both = s.memory * covariance_;
    a.innovation = a.offset + a.remembered + 2.0 * a.both + square(s.fresh);
    return a;
}

Expectation BrakeFilter::expected(double c_e_J) const {
    double mean = 0.0;
    double squares = 0.0;
    for (const Hypothesis& h : hypotheses_) {
        const double m = predicted(h, c_e_J);
        mean += h.weight * m;
        squares += h.weight * m * m;
    }
    return {mean, std::sqrt(ahead(c_e_J).innovation + std::max(0.0, squares - mean * mean))};
}

double BrakeFilter::score(const Point& point) const {
    const double root = std::sqrt(2.0 * ahead(point.c_e_J).innovation);
    double below = 0.0;
    double above = 0.0;
    for (const Hypothesis& h : hypotheses_) {
        if (h.weight < 1e-18) continue;
        const double off = (point.mean_friction - predicted(h, point.c_e_J)) / root;
        below += h.weight * 0.5 * std::erfc(-off);
        above += h.weight * 0.5 * std::erfc(off);
    }
    const double tail = std::min(below, above);
    const double size = tail < 1e-15 ? kMax : std::min(kMax, std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * tail));
    return below < above ? -size : size;
}

double BrakeFilter::log_density(const Point& point) const {
    const double variance = ahead(point.c_e_J).innovation;
    double greatest = -std::numeric_limits<double>::infinity();
    for (const Hypothesis& h : hypotheses_) {
        const double off = point.mean_friction - predicted(h, point.c_e_J);
        greatest = std::max(greatest, std::log(h.weight) - 0.5 * off * off / variance);
    }
    double sum = 0.0;
    for (const Hypothesis& h : hypotheses_) {
        const double off = point.mean_friction - predicted(h, point.c_e_J);
        sum += std::exp(std::log(h.weight) - 0.5 * off * off / variance - greatest);
    }
    return greatest + std::log(sum) - 0.5 * std::log(2.0 * std::numbers::pi * variance);
}

void BrakeFilter::learn(const Point& point) {
    constexpr double kMinWeight = 1e-12;  // so that a hypothesis that was nearly excluded can return
    const Ahead a = ahead(point.c_e_J);
    const double gain_offset = (a.offset + a.both) / a.innovation;
    const double gain_remembered = (a.remembered + a.both) / a.innovation;
    const double kept = population_->spread.evidence_kept;
    double greatest = -std::numeric_limits<double>::infinity();
    for (Hypothesis& h : hypotheses_) {
        const double off = point.mean_friction - predicted(h, point.c_e_J);
        h.offset += gain_offset * off;
        h.remembered = population_->scatter.memory * h.remembered + gain_remembered * off;
        h.weight = kept * std::log(h.weight) + (1.0 - kept) * std::log(h.prior) - 0.5 * off * off / a.innovation;
        greatest = std::max(greatest, h.weight);
    }
    double sum = 0.0;
    for (Hypothesis& h : hypotheses_) {
        h.weight = std::max(kMinWeight, std::exp(h.weight - greatest));
        sum += h.weight;
    }
    for (Hypothesis& h : hypotheses_) h.weight /= sum;
    variance_offset_ = a.offset - square(gain_offset) * a.innovation;
    variance_remembered_ = a.remembered - square(gain_remembered) * a.innovation;
    covariance_ = a.both - gain_offset * gain_remembered * a.innovation;
    c_e_J_ = point.c_e_J;
    begun_ = true;
}

}  // namespace wear
