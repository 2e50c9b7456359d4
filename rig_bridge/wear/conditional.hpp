/// Distribution of the next maneuver's mean friction, given the energy that the brake has taken: eq. (14), and its exact form.
#pragma once

#include <vector>

#include "rig_bridge/wear/mixture.hpp"

namespace wear {

/// The printed eq. (14) has the variance (1 - rho) sigma_b^2; that of a bivariate normal is (1 - rho^2) sigma_b^2.
enum class Variance { exact, printed };

/// The component whose mean is nearest on the energy axis (the paper; it jumps where components meet), or every component j, weighted by
/// w_j N(a; c_j, sigma_cj^2) (exact).
enum class Choice { nearest, mixture };

struct ConditionalRule {
    Variance variance = Variance::exact;
    Choice choice = Choice::mixture;
    bool operator==(const ConditionalRule&) const = default;
};

/// P(mean mu_b | c_e = a): a mixture of normal distributions; weights are positive and add up to 1.
struct Conditional {
    struct Term {
        double weight = 0.0;
        double mean = 0.0;
        double variance = 0.0;
    };
    std::vector<Term> terms;

    [[nodiscard]] double mean() const;
    [[nodiscard]] double variance() const;
    [[nodiscard]] double cumulative(double friction) const;
    /// One random draw; unbounded, as the normal distribution.
    [[nodiscard]] double sample(Generator& generator) const;
};

/// At any finite energy a [J].
[[nodiscard]] Conditional friction_given_energy(const Mixture& mixture, double a_J, const ConditionalRule& rule = {});

/// The same, with the components' weights taken at `weigh_at_J` and their means at `a_J`. For extrapolation: beyond the data the weights at `a_J`
/// would favour the widest component, without basis in the data.
[[nodiscard]] Conditional friction_given_energy(const Mixture& mixture, double a_J, double weigh_at_J, const ConditionalRule& rule);

}  // namespace wear
