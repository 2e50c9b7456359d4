/// Gaussian mixture over x = [c_e, mean mu_b], eq. (10) to (13), in SI units.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "rig_bridge/wear/draw.hpp"
#include "rig_bridge/wear/wear_campaign.hpp"

namespace wear {

/// One term of eq. (10); its covariance matrix is positive definite.
struct Component {
    double weight = 1.0;      ///< w_i, in (0, 1]
    double mean_c_e_J = 0.0;  ///< mu_i, first element
    double mean_friction = 0.0;
    double variance_c_e_J2 = 1.0;  ///< sigma_i, the matrix
    double covariance_J = 0.0;
    double variance_friction = 1.0;

    [[nodiscard]] double correlation() const;
    /// log(w_i N(x; mu_i, sigma_i)), per J.
    [[nodiscard]] double log_density(const Point& x) const;
    bool operator==(const Component&) const = default;
};

class Mixture {
  public:
    /// At least one component; throws std::invalid_argument for a weight outside (0, 1], weights that do not add up to 1 within 1e-9
    /// (eq. 11), a number that is not finite, or a covariance matrix that is not positive definite.
    explicit Mixture(std::vector<Component> components);

    [[nodiscard]] const std::vector<Component>& components() const { return components_; }

    /// p(x | phi) of eq. (10), per J.
    [[nodiscard]] double density(const Point& x) const;
    [[nodiscard]] double log_density(const Point& x) const;
    /// Eq. (13).
    [[nodiscard]] double log_likelihood(std::span<const Point> points) const;
    /// The most likely component of x (the colours of Fig. 8).
    [[nodiscard]] std::size_t member(const Point& x) const;
    /// One draw of x.
    [[nodiscard]] Point sample(Generator& generator) const;

    bool operator==(const Mixture&) const = default;

  private:
    std::vector<Component> components_;
};

/// Free parameters of M components: M means, M covariance matrices, M - 1 weights.
[[nodiscard]] constexpr std::size_t parameters_of(std::size_t components) {
    return 6 * components - 1;
}

/// Bayesian information criterion (Schwarz 1978), smaller is better: -2 log L + k log n.
[[nodiscard]] double bic(double log_likelihood, std::size_t components, std::size_t points);

}  // namespace wear
