/// Estimates the state of a brake from its own maneuvers, with other brakes as prior (population.hpp).
///
/// Hypotheses: this brake follows the mean curve m_k of member k of the population, taking s times the energy for the same wear. Under each
/// of them friction of maneuver i is
///
///     mu_i = m_k(c_e / s) + offset + remembered + fresh
///
/// with a slowly drifting offset (a random walk in energy), scatter correlated from one maneuver to the next (autoregressive, order 1), and
/// uncorrelated scatter. For given k and s this is linear and Gaussian: there is one Kalman filter for each pair, weighted by likelihood. Exact,
/// without random draws. The covariance is the same for all hypotheses.
#pragma once

#include <cstddef>
#include <vector>

#include "rig_bridge/wear/population.hpp"

namespace wear {

/// Predicted friction of the next maneuver: a weighted mixture of normal distributions with equal variance.
struct Expectation {
    double mean = 0.0;
    double deviation = 0.0;
};

class BrakeFilter {
  public:
    struct Hypothesis {
        std::size_t member = 0;
        double energy_scale = 1.0;  ///< s
        double weight = 0.0;        ///< the weights sum to 1
        double prior = 0.0;         ///< weight before any maneuver
        double offset = 0.0;        ///< mean, after the newest point
        double remembered = 0.0;    ///< likewise
    };

    /// `population` must outlive this.
    explicit BrakeFilter(const Population& population);
    explicit BrakeFilter(Population&&) = delete;

    [[nodiscard]] Expectation expected(double c_e_J) const;
    /// The point's quantile in its predicted distribution, as standard normal deviate: standard normal and independent for brakes of the population.
    /// Limited to -8 to 8.
    [[nodiscard]] double score(const Point& point) const;
    /// log p(point | points so far), per unit of friction.
    [[nodiscard]] double log_density(const Point& point) const;
    /// Adds a point; call in the order of the maneuvers.
    void learn(const Point& point);

    [[nodiscard]] const std::vector<Hypothesis>& hypotheses() const { return hypotheses_; }
    [[nodiscard]] double offset_variance() const { return variance_offset_; }
    [[nodiscard]] const Population& population() const { return *population_; }
    /// Mean friction without scatter under a hypothesis, at its own offset.
    [[nodiscard]] double mean_friction(const Hypothesis& hypothesis, double c_e_J) const;

  private:
    /// Covariances predicted for the next maneuver.
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
