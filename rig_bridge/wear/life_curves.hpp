/// Friction over the share of a brake's life as a Gaussian process, learnt from brakes that were worn out, and the filter that takes from it what a
/// brake in use says of its own life.
///
/// Maneuver i begins when the share u of the brake's life L (an energy) is taken. Its friction is
///
///     mu_i = curve(u) + sum over k of energy_k (e_(i-k) / e_mean - 1) + remembered + fresh
///
/// `curve` is piecewise linear between the knots; its values there are normal, with a mean that depends on log L and a covariance between them. The
/// second term is what the energies of the maneuvers before do (a hot brake, a glaze that a heavy stop breaks). `remembered` is autoregressive of
/// order 1, `fresh` is white. For a given L all of this is linear and normal: one Kalman filter for each L of a grid, weighed by likelihood. Exact,
/// without random draws.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <vector>

#include "rig_bridge/wear/brake_filter.hpp"

namespace wear {

/// Shares of life. Denser where friction changes fast: run-in and wear-out. Beyond the last one the curve goes on straight, and flat from 1.08 on.
inline constexpr std::array kLifeKnots{0.0, 0.02, 0.05, 0.1, 0.17, 0.3, 0.45, 0.6, 0.72, 0.82, 0.9, 0.96, 1.02};
inline constexpr int kCurve = static_cast<int>(kLifeKnots.size());
inline constexpr std::size_t kEnergiesBefore = 6;

struct LifeCurves {
    using Values = Eigen::Matrix<double, kCurve, 1>;  ///< at the knots
    using Covariance = Eigen::Matrix<double, kCurve, kCurve>;

    std::size_t lives = 0;  ///< learnt from
    double landing_J = 0.0;  ///< mean energy of a maneuver
    double log_life = 0.0;   ///< mean of log L, L in J
    double log_life_deviation = 0.0;
    Values mean = Values::Zero();
    Values by_life = Values::Zero();  ///< change of the mean for each standard deviation of log L
    Covariance covariance = Covariance::Identity();
    std::array<double, kEnergiesBefore> energy{};  ///< friction for e_mean more, of the maneuver before, the one before that, ...
    Scatter scatter;                               ///< without drift
    /// Exponent of the likelihood, in (0, 1]: a curve learnt from few lives is not quite that of the next brake, and its errors add up over maneuvers.
    double evidence = 1.0;
};

/// Energy after the maneuver with which the brake is worn out: the last one before friction stays below `limit`, by the greatest sum of what
/// friction is above it; the campaign's last where nothing but scatter is below.
[[nodiscard]] double end_of_life_J(const Campaign& campaign, double limit);

/// By expectation maximisation. `evidence` is that with which lives left out of the learning are foretold best, by the logarithmic score of log L at
/// each tenth of life. At least 3 campaigns that begin with a new brake, else std::invalid_argument.
[[nodiscard]] LifeCurves learn_life_curves(const std::vector<Campaign>& campaigns, double limit);

class LifeFilter {
  public:
    /// Any life: Student's t of log L, as one more of the lives learnt from.
    explicit LifeFilter(const LifeCurves& curves);
    /// The life is known.
    LifeFilter(const LifeCurves& curves, double life_J);

    /// Adds a point; call in the order of the maneuvers.
    void learn(const Point& point);

    struct Life {
        double life_J = 0.0;
        double weight = 0.0;  ///< the weights sum to 1
    };
    /// Rising.
    [[nodiscard]] std::vector<Life> lives() const;
    /// `count` equally probable lives, rising. Between two lives of the grid the probability is spread evenly.
    [[nodiscard]] std::vector<double> lives_J(std::size_t count) const;

    /// Friction of the next maneuver.
    [[nodiscard]] Expectation expected() const;
    /// log p(friction of the next maneuver | points so far).
    [[nodiscard]] double log_density(double friction) const;

    /// Values at the knots and, last, `remembered`, of one life.
    static constexpr int kStates = kCurve + 1;
    struct Hypothesis {
        double life_J = 0.0;
        double log_prior = 0.0;
        double log_likelihood = 0.0;
        Eigen::Matrix<double, kStates, 1> state;
        Eigen::Matrix<double, kStates, kStates> covariance;
    };
    [[nodiscard]] const std::vector<Hypothesis>& hypotheses() const { return hypotheses_; }
    [[nodiscard]] double taken_J() const { return taken_J_; }

  private:
    struct Predicted {
        double mean = 0.0, variance = 0.0;
    };
    [[nodiscard]] double of_energies() const;
    [[nodiscard]] Predicted predicted(const Hypothesis& hypothesis) const;
    void add(double life_J, double deviations, double log_prior);

    const LifeCurves* curves_;
    std::vector<Hypothesis> hypotheses_;
    std::array<double, kEnergiesBefore> energies_{};  // relative to the mean, less 1; newest first
    double taken_J_ = 0.0;
    bool begun_ = false;
};

/// The knot before a share of life, and the weight of the next one.
struct KnotPlace {
    int knot = 0;
    double next = 0.0;
};
[[nodiscard]] KnotPlace knot_place(double share);

}  // namespace wear
