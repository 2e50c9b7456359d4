#include "rig_bridge/wear/mixture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace wear {

double Component::correlation() const {
    return covariance_J / std::sqrt(variance_c_e_J2 * variance_friction);
}

double Component::log_density(const Point& x) const {
    const double rho = correlation();
    const double rest = (1.0 - rho) * (1.0 + rho);
    const double zc = (x.c_e_J - mean_c_e_J) / std::sqrt(variance_c_e_J2);
    const double zm = (x.mean_friction - mean_friction) / std::sqrt(variance_friction);
    const double off = zm - rho * zc;
    return std::log(weight) - std::log(2.0 * std::numbers::pi) -
           0.5 * (std::log(variance_c_e_J2) + std::log(variance_friction) + std::log(rest) + zc * zc + off * off / rest);
}

Mixture::Mixture(std::vector<Component> components) : components_(std::move(components)) {
    if (components_.empty()) throw std::invalid_argument("a mixture needs at least one component");
    double sum = 0.0;
    for (std::size_t i = 0; i < components_.size(); ++i) {
        const Component& c = components_[i];
        const bool finite =
            std::isfinite(c.mean_c_e_J) && std::isfinite(c.mean_friction) && std::isfinite(c.variance_c_e_J2) && std::isfinite(c.variance_friction);
        if (!finite || !(c.weight > 0.0 && c.weight <= 1.0))
            throw std::invalid_argument(fmt::format("component {}: weight must be within 0 to 1, all numbers finite", i + 1));
        if (!(c.variance_c_e_J2 > 0.0 && c.variance_friction > 0.0 && std::abs(c.correlation()) < 1.0))
            throw std::invalid_argument(fmt::format("component {}: the covariance matrix is not positive definite", i + 1));
        sum += c.weight;
    }
    if (std::abs(sum - 1.0) > 1e-9) throw std::invalid_argument(fmt::format("the weights add up to {}, not to 1 (eq. 11)", sum));
}

double Mixture::log_density(const Point& x) const {
    double greatest = -std::numeric_limits<double>::infinity();
    for (const Component& c : components_) greatest = std::max(greatest, c.log_density(x));
    if (!std::isfinite(greatest)) return greatest;
    double sum = 0.0;
    for (const Component& c : components_) sum += std::exp(c.log_density(x) - greatest);
    return greatest + std::log(sum);
}

double Mixture::density(const Point& x) const {
    return std::exp(log_density(x));
}

double Mixture::log_likelihood(std::span<const Point> points) const {
    double sum = 0.0;
    for (const Point& x : points) sum += log_density(x);
    return sum;
}

std::size_t Mixture::member(const Point& x) const {
    const auto at = std::max_element(components_.begin(), components_.end(),
                                     [&](const Component& a, const Component& b) { return a.log_density(x) < b.log_density(x); });
    return static_cast<std::size_t>(at - components_.begin());
}

Point Mixture::sample(Generator& generator) const {
    double left = uniform(generator);
    const Component* chosen = &components_.back();
    for (const Component& c : components_) {
        if (left < c.weight) {
            chosen = &c;
            break;
        }
        left -= c.weight;
    }
    const double rho = chosen->correlation();
    const double zc = normal(generator);
    const double zm = rho * zc + std::sqrt((1.0 - rho) * (1.0 + rho)) * normal(generator);
    return {chosen->mean_c_e_J + std::sqrt(chosen->variance_c_e_J2) * zc, chosen->mean_friction + std::sqrt(chosen->variance_friction) * zm};
}

double bic(double log_likelihood, std::size_t components, std::size_t points) {
    return -2.0 * log_likelihood + static_cast<double>(parameters_of(components)) * std::log(static_cast<double>(points));
}

}  // namespace wear
