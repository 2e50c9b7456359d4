/// What this brake's own maneuvers say about it, given what other brakes were like (population.hpp).
///
/// Hypotheses: this brake follows the mean curve m_k of member k of the population, taking s times the energy for the same wear. Under each
/// of them friction of maneuver i is
///
///     mu_i = m_k(c_e / s) + offset + remembered + fresh
///
/// with an offset that drifts slowly (a random walk in energy), scatter that remembers from one maneuver to the next (autoregressive,
/// order 1), and scatter that does not. That is linear and Gaussian but for k and s: one Kalman filter for each pair of them, weighed by
/// their likelihoods. Exact, no draws. Covariances do not depend on the hypothesis, so that there is one for all.
#pragma once

#include <cstddef>
#include <vector>

#include "rig_bridge/wear/population.hpp"

namespace wear {

/// Friction of the next maneuver: normal distributions with one variance, by weight.
struct Expectation {
    double mean = 0.0;
    double deviation = 0.0;
};

class BrakeFilter {
  public:
    struct Hypothesis {
        std::size_t member = 0;
        double energy_scale = 1.0;  ///< s
        double weight = 0.0;        ///< of all 1
        double prior = 0.0;         ///< its weight before any maneuver
        double offset = 0.0;        ///< mean, after the newest point
        double remembered = 0.0;    ///< likewise
    };

    /// `population` must outlive this.
    explicit BrakeFilter(const Population& population);
    explicit BrakeFilter(Population&&) = delete;

    [[nodiscard]] Expectation expected(double c_e_J) const;
    /// Where the point lies in the distribution that the points so far predict for it, as the standard normal deviate of the same
    /// probability: normal and independent for brakes like those of the population. Within -8 to 8.
    [[nodiscard]] double score(const Point& point) const;
    /// log p(point | points so far), per unit of friction.
    [[nodiscard]] double log_density(const Point& point) const;
    /// Points in the order of the maneuvers.
    void learn(const Point& point);

    [[nodiscard]] const std::vector<Hypothesis>& hypotheses() const { return hypotheses_; }
    [[nodiscard]] double offset_variance() const { return variance_offset_; }
    [[nodiscard]] const Population& population() const { return *population_; }
    /// Mean friction without scatter under a hypothesis, at its own offset.
    [[nodiscard]] double mean_friction(const Hypothesis& hypothesis, double c_e_J) const;

  private:
    /// Covariances one maneuver on.
    struct Ahead {
        double offset, remembered, both, innovation;
    };
    [[nodiscard]] Ahead ahead(double c_e_J) const;
    [[nodiscard]] double predicted(const Hypothesis& hypothesis, double c_e_J) const;

    const Population* population_;
    std::vector<Hypothesis> hypotheses_;
    double variance_offset_;
    double variance_remembered_;
    double covariance_ = 0.0;
    double c_e_J_ = 0.0;  // of the newest point
    bool begun_ = false;
};

}  // namespace wear
