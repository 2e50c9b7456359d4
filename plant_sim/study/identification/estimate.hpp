/// An estimate with its interval, and least squares that give one.
///
/// Residuals of a real rig are correlated: what the model lacks lasts. So covariances are sandwiches, B M B with B the inverse of J'J and M the
/// long-run covariance of the scores J_t r_t after Newey and West (Econometrica 55, 1987), which needs neither white residuals nor equal
/// variances. Scores are first summed over batches of samples; the number of lags follows from the scores' own correlation (Andrews,
/// Econometrica 59, 1991, AR(1) plug-in), and critical values are those of Kiefer and Vogelsang (Econometric Theory 21, 2005), which widen the
/// interval where the lags are not few against the batches.
///
/// Where few samples decide, their scores show little of their own variance. Residuals that are white by their expected covariance may share
/// theirs instead (LeastSquares::whitened): then M is the sum of J_s' g(s - t) J_t, with g the autocovariance of all residuals.
#pragma once

#include <Eigen/Core>

#include <functional>
#include <span>
#include <string>

namespace identification {

struct Estimate {
    double value = 0.0;
    double deviation = 0.0;  ///< standard
    double low = 0.0, high = 0.0;

    [[nodiscard]] bool contains(double truth) const { return truth >= low && truth <= high; }
};

/// The same in another unit. `factor`: positive.
[[nodiscard]] Estimate scaled(const Estimate& e, double factor);

struct Fit {
    Eigen::VectorXd theta;
    Eigen::MatrixXd covariance;  ///< sandwich
    Eigen::VectorXd residuals;
    int iterations = 0;
    bool converged = false;
    int lags = 0;                    ///< of the long-run covariance, in batches
    double widen = 1.0;              ///< of critical values against those of the normal distribution
    double rms = 0.0;                ///< of the residuals
    double first_correlation = 0.0;  ///< of neighbouring residuals

    /// 95 %; `of` parameters that shall all lie in their intervals together with that probability (Bonferroni).
    [[nodiscard]] Estimate estimate(Eigen::Index i, int of = 1) const;
    /// Of a sum gradient' theta.
    [[nodiscard]] Estimate combination(const Eigen::VectorXd& gradient, int of = 1) const;
};

/// Fills `residuals` (measured - modelled, divided by its expected deviation where that varies) for parameters theta. Always as many.
using Residuals = std::function<void(const Eigen::VectorXd& theta, Eigen::VectorXd& residuals)>;

struct LeastSquares {
    Eigen::VectorXd start;
    Eigen::VectorXd scale;  ///< of each parameter: a change by it matters; differences are taken over 1e-4 of it
    Eigen::VectorXd min, max;
    int batch = 1;  ///< samples to a batch
    /// The residuals are divided by their whole expected covariance: variance and correlation that are left count as the same everywhere.
    bool whitened = false;
    int max_iterations = 60;
};

/// Levenberg-Marquardt with central differences. Throws NotIdentifiable where the residuals do not depend on some combination of parameters,
/// naming the one of `names` that it is mostly made of.
[[nodiscard]] Fit fit(const LeastSquares& problem, std::span<const std::string> names, const Residuals& residuals);

}  // namespace identification
