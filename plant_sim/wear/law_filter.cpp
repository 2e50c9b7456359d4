#include "plant_sim/wear/law_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace wear::arena {

namespace {

/// The particle at `share` of the weights.
std::size_t particle(const std::vector<double>& weights, double share, std::size_t from, double& below) {
    std::size_t i = from;
    for (; i + 1 < weights.size() && below + weights[i] <= share; ++i) below += weights[i];
    return i;
}

}  // namespace

LawFilter::LawFilter(Law law, const Settings& settings, std::uint64_t seed)
    : limit_(settings.limit), reading_error_(settings.reading_error), generator_(generator_of(seed, 6000)), weights_(kParticles, 1.0 / kParticles) {
    brakes_.reserve(kParticles);
    // Seeds that no judged brake has.
    constexpr std::uint64_t kOthers = 1'000'000'000;
    for (std::size_t i = 0; i < kParticles; ++i) brakes_.emplace_back(law, settings, kOthers + seed * kParticles + i);
}

Expectation LawFilter::expected() const {
    double mean = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < kParticles; ++i) {
        const double x = brakes_[i].expected();
        mean += weights_[i] * x;
        squares += weights_[i] * x * x;
    }
    return {mean, std::sqrt(std::max(0.0, squares - mean * mean) + Brake::kFresh * Brake::kFresh)};
}

void LawFilter::learn(const Point& point) {
    const double energy_J = point.c_e_J - taken_J_;
    taken_J_ = point.c_e_J;
    std::vector<double> log_likelihoods(kParticles);
    for (std::size_t i = 0; i < kParticles; ++i) {
        const double off = (point.mean_friction - brakes_[i].expected()) / Brake::kFresh;
        log_likelihoods[i] = -0.5 * off * off;
        (void)brakes_[i].land(energy_J, generator_);
    }
    weigh(log_likelihoods);
}

void LawFilter::read(const LiningReading& reading) {
    std::vector<double> log_likelihoods(kParticles);
    for (std::size_t i = 0; i < kParticles; ++i) {
        const double off = (reading.worn - brakes_[i].worn()) / reading_error_;
        log_likelihoods[i] = -0.5 * off * off;
    }
    weigh(log_likelihoods);
}

void LawFilter::weigh(const std::vector<double>& log_likelihoods) {
    double greatest = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < kParticles; ++i) {
        weights_[i] = std::log(weights_[i]) + log_likelihoods[i];
        greatest = std::max(greatest, weights_[i]);
    }
    double sum = 0.0, squares = 0.0;
    for (double& w : weights_) sum += w = std::max(1e-300, std::exp(w - greatest));
    for (double& w : weights_) {
        w /= sum;
        squares += w * w;
    }
    if (1.0 / squares < 0.125 * kParticles) resample();
}

void LawFilter::resample() {
    constexpr double kShrink = 0.985;
    const double fresh = std::sqrt(1.0 - kShrink * kShrink);
    double mean_life = 0.0, mean_level = 0.0, life2 = 0.0, level2 = 0.0;
    for (std::size_t i = 0; i < kParticles; ++i) {
        mean_life += weights_[i] * std::log(brakes_[i].life_J());
        mean_level += weights_[i] * brakes_[i].level();
    }
    for (std::size_t i = 0; i < kParticles; ++i) {
        life2 += weights_[i] * std::pow(std::log(brakes_[i].life_J()) - mean_life, 2);
        level2 += weights_[i] * std::pow(brakes_[i].level() - mean_level, 2);
    }
    std::vector<Brake> out;
    out.reserve(kParticles);
    double below = 0.0;
    std::size_t i = 0;
    for (std::size_t k = 0; k < kParticles; ++k) {
        i = particle(weights_, (static_cast<double>(k) + 0.5) / kParticles, i, below);
        const double life = kShrink * std::log(brakes_[i].life_J()) + (1.0 - kShrink) * mean_life + fresh * std::sqrt(life2) * normal(generator_);
        const double level = kShrink * brakes_[i].level() + (1.0 - kShrink) * mean_level + fresh * std::sqrt(level2) * normal(generator_);
        out.push_back(brakes_[i].with(std::exp(life), level));
    }
    brakes_ = std::move(out);
    weights_.assign(kParticles, 1.0 / kParticles);
}

std::vector<Brake> LawFilter::drawn(std::size_t count) const {
    std::vector<double> weights = weights_;
    double sum = 0.0;
    for (std::size_t i = 0; i < kParticles; ++i) {
        if (taken_J_ > 0.0 && brakes_[i].condition() < limit_) weights[i] = 1e-300;
        sum += weights[i];
    }
    std::vector<Brake> out;
    out.reserve(count);
    double below = 0.0;
    std::size_t i = 0;
    for (std::size_t k = 0; k < count; ++k) {
        i = particle(weights, sum * (static_cast<double>(k) + 0.5) / static_cast<double>(count), i, below);
        out.push_back(brakes_[i]);
    }
    return out;
}

}  // namespace wear::arena
