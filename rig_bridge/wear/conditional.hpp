/// Mean friction of the next maneuver, given the energy that the brake has taken: eq. (14), and the exact form of it.
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
    /// One draw, unbounded as the normal distribution is.
    [[nodiscard]] double sample(Generator& generator) const;
};

/// At any finite energy a [J].
[[nodiscard]] Conditional friction_given_energy(const Mixture& mixture, double a_J, const ConditionalRule& rule = {});

/// The same, but which components speak is asked at `weigh_at_J`, and what they say at `a_J`: beyond the data their lines go on, whereas the
/// weights there would fall to whichever component is widest, for no reason in the data.
[[nodiscard]] Conditional friction_given_energy(const Mixture& mixture, double a_J, double weigh_at_J, const ConditionalRule& rule);

}  // namespace wear
