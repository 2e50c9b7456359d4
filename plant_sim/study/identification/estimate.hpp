/// An estimate with its interval, and a least-squares fit that returns such estimates.
///
/// Residuals of a real rig are correlated, since errors of the model persist. The covariance is therefore a sandwich, B M B: B is the inverse of J'J,
/// M the long-run covariance of the scores J_t r_t after Newey and West (Econometrica 55, 1987), which assumes neither white residuals nor equal
/// variances. Scores are first summed over batches of samples; the number of lags follows from the scores' own correlation (Andrews, Econometrica 59,
/// 1991, AR(1) plug-in). Critical values are those of Kiefer and Vogelsang (Econometric Theory 21, 2005), which widen the interval if the lags are
/// not few compared with the batches.
///
/// If few samples determine a parameter, their scores are too few to show their variance. Residuals that were divided by their expected covariance
/// may then be pooled (LeastSquares::whitened): M is the sum of J_s' g(s - t) J_t, with g the autocovariance of all residuals.
#pragma once

#include <Eigen/Core>

#include <functional>
#include <span>
#include <string>

namespace identification {

struct Estimate {
    double value = 0.0;
    double deviation = 0.0;  ///< standard deviation
    double low = 0.0, high = 0.0;

    [[nodiscard]] bool contains(double truth) const { return truth >= low && truth <= high; }
};

/// `e` in another unit; `factor` > 0.
[[nodiscard]] Estimate scaled(const Estimate& e, double factor);

struct Fit {
    Eigen::VectorXd theta;
    Eigen::MatrixXd covariance;  ///< sandwich
    Eigen::VectorXd residuals;
    int iterations = 0;
    bool converged = false;
    int lags = 0;                    ///< of the long-run covariance, in batches
    double widen = 1.0;              ///< factor of the critical values over those of the normal distribution
    double rms = 0.0;                ///< of the residuals
    double first_correlation = 0.0;  ///< of adjacent residuals

    /// Parameter `i` with a 95 % interval; `of`: number of parameters that shall lie in their intervals jointly with that probability (Bonferroni).
    [[nodiscard]] Estimate estimate(Eigen::Index i, int of = 1) const;
    /// The same for the sum gradient' theta.
    [[nodiscard]] Estimate combination(const Eigen::VectorXd& gradient, int of = 1) const;
};

/// Fills `residuals` (measured - modelled, divided by the expected deviation if that varies) for parameters theta. Their number must not change.
using Residuals = std::function<void(const Eigen::VectorXd& theta, Eigen::VectorXd& residuals)>;

struct LeastSquares {
    Eigen::VectorXd start;
    Eigen::VectorXd scale;  ///< of each parameter: size of a significant change; differences are taken over 1e-4 of it
    Eigen::VectorXd min, max;
    int batch = 1;  ///< number of samples per batch
    /// Whether the residuals are divided by their full expected covariance, so that the remaining variance and correlation may be pooled.
    bool whitened = false;
    int max_iterations = 60;
};

/// Levenberg-Marquardt with central differences. Throws NotIdentifiable if the residuals do not depend on some combination of parameters; its text
/// gives the one of `names` with the largest part in it.
[[nodiscard]] Fit fit(const LeastSquares& problem, std::span<const std::string> names, const Residuals& residuals);

}  // namespace identification
