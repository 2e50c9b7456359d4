#include "rig_bridge/wear/conditional.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wear {

namespace {

Conditional::Term term_of(const Component& c, double weight, double a_J, Variance variance) {
    const double rho = c.correlation();
    const double share = variance == Variance::exact ? (1.0 - rho) * (1.0 + rho) : 1.0 - rho;
    return {weight, c.mean_friction + c.covariance_J / c.variance_c_e_J2 * (a_J - c.mean_c_e_J), share * c.variance_friction};
}

/// log(w_j N(a; c_j, sigma_cj^2)) without its constant.
double log_weight(const Component& c, double a_J) {
    const double z = (a_J - c.mean_c_e_J) / std::sqrt(c.variance_c_e_J2);
    return std::log(c.weight) - 0.5 * (std::log(c.variance_c_e_J2) + z * z);
}

}  // namespace

double Conditional::mean() const {
    double sum = 0.0;
    for (const Term& t : terms) sum += t.weight * t.mean;
    return sum;
}

double Conditional::variance() const {
    const double m = mean();
    double sum = 0.0;
    for (const Term& t : terms) sum += t.weight * (t.variance + (t.mean - m) * (t.mean - m));
    return sum;
}

double Conditional::cumulative(double friction) const {
    double sum = 0.0;
    for (const Term& t : terms) sum += t.weight * 0.5 * std::erfc((t.mean - friction) / std::sqrt(2.0 * t.variance));
    return sum;
}

double Conditional::sample(Generator& generator) const {
    double left = uniform(generator);
    const Term* chosen = &terms.back();
    for (const Term& t : terms) {
        if (left < t.weight) {
            chosen = &t;
            break;
        }
        left -= t.weight;
    }
    return chosen->mean + std::sqrt(chosen->variance) * normal(generator);
}

Conditional friction_given_energy(const Mixture& mixture, double a_J, const ConditionalRule& rule) {
    return friction_given_energy(mixture, a_J, a_J, rule);
}

Conditional friction_given_energy(const Mixture& mixture, double a_J, double weigh_at_J, const ConditionalRule& rule) {
    const std::vector<Component>& all = mixture.components();
    if (rule.choice == Choice::nearest) {
        const auto near = std::min_element(all.begin(), all.end(), [&](const Component& p, const Component& q) {
            return std::abs(weigh_at_J - p.mean_c_e_J) < std::abs(weigh_at_J - q.mean_c_e_J);
        });
        return {{term_of(*near, 1.0, a_J, rule.variance)}};
    }
    double greatest = -std::numeric_limits<double>::infinity();
    for (const Component& c : all) greatest = std::max(greatest, log_weight(c, weigh_at_J));
    Conditional out;
    out.terms.reserve(all.size());
    double sum = 0.0;
    for (const Component& c : all) {
        const double weight = std::exp(log_weight(c, weigh_at_J) - greatest);
        if (weight == 0.0) continue;
        out.terms.push_back(term_of(c, weight, a_J, rule.variance));
        sum += weight;
    }
    for (Conditional::Term& t : out.terms) t.weight /= sum;
    return out;
}

}  // namespace wear
