#include "plant_sim/study/identification/estimate.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

#include "plant_sim/study/identification/recording.hpp"

namespace identification {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd jacobian(const LeastSquares& problem, const Residuals& residuals, const VectorXd& theta, Index rows) {
    constexpr double kStep = 1e-4;
    MatrixXd j(rows, theta.size());
    VectorXd above(rows), below(rows);
    for (Index i = 0; i < theta.size(); ++i) {
        VectorXd up = theta;
        VectorXd down = theta;
        up[i] = std::min(up[i] + kStep * problem.scale[i], problem.max[i]);
        down[i] = std::max(down[i] - kStep * problem.scale[i], problem.min[i]);
        residuals(up, above);
        residuals(down, below);
        j.col(i) = (above - below) * (problem.scale[i] / (up[i] - down[i]));
    }
    return j;
}

/// Number of lags of a Bartlett window for scores that are approximately AR(1): the largest of all parameters.
int lags_for(const MatrixXd& scores) {
    constexpr double kLargestCorrelation = 0.97;
    const Index n = scores.rows();
    double alpha = 0.0;
    for (Index i = 0; i < scores.cols(); ++i) {
        const auto s = scores.col(i);
        const double power = s.squaredNorm();
        if (power <= 0.0) continue;
        const double rho = std::min(std::abs(s.head(n - 1).dot(s.tail(n - 1))) / power, kLargestCorrelation);
        alpha = std::max(alpha, 4.0 * rho * rho / std::pow((1.0 - rho) * (1.0 + rho), 2.0));
    }
    const auto count = static_cast<double>(n);
    const double lags = 1.1447 * std::cbrt(alpha * count);
    return static_cast<int>(std::clamp(std::ceil(lags), 2.0, std::max(2.0, count / 8.0)));
}

MatrixXd long_run(const MatrixXd& scores, int lags) {
    const Index n = scores.rows();
    MatrixXd sum = scores.transpose() * scores;
    for (Index lag = 1; lag <= std::min<Index>(lags, n - 1); ++lag) {
        const double weight = 1.0 - static_cast<double>(lag) / (lags + 1.0);
        const MatrixXd shifted = scores.topRows(n - lag).transpose() * scores.bottomRows(n - lag);
        sum += weight * (shifted + shifted.transpose());
    }
    return sum;
}

MatrixXd batched_scores(const MatrixXd& j, const VectorXd& r, int batch) {
    const Index batches = (r.size() + batch - 1) / batch;
    MatrixXd scores(batches, j.cols());
    for (Index b = 0; b < batches; ++b) {
        const Index from = b * batch;
        const Index count = std::min<Index>(batch, r.size() - from);
        scores.row(b) = r.segment(from, count).transpose() * j.middleRows(from, count);
    }
    return scores;
}

/// The same for residuals whose correlation depends only on their distance.
MatrixXd long_run_of_stationary(const MatrixXd& j, const VectorXd& r, int lags) {
    const Index n = r.size();
    MatrixXd sum = r.squaredNorm() / static_cast<double>(n) * (j.transpose() * j);
    for (Index lag = 1; lag <= std::min<Index>(lags, n - 1); ++lag) {
        const double weight = 1.0 - static_cast<double>(lag) / (lags + 1.0);
        const double covariance = r.head(n - lag).dot(r.tail(n - lag)) / static_cast<double>(n);
        const MatrixXd shifted = j.topRows(n - lag).transpose() * j.bottomRows(n - lag);
        sum += weight * covariance * (shifted + shifted.transpose());
    }
    return sum;
}

void check_information(const MatrixXd& normal, std::span<const std::string> names) {
    constexpr double kMin = 1e-12;
    const VectorXd size = normal.diagonal().cwiseSqrt();
    for (Index i = 0; i < size.size(); ++i) {
        if (!(size[i] > 0.0)) throw NotIdentifiable("the recordings do not depend on " + names[static_cast<std::size_t>(i)]);
    }
    const MatrixXd correlation = size.cwiseInverse().asDiagonal() * normal * size.cwiseInverse().asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(correlation);
    if (solver.eigenvalues()[0] > kMin) return;
    Index worst = 0;
    solver.eigenvectors().col(0).cwiseAbs().maxCoeff(&worst);
    throw NotIdentifiable("the recordings cannot tell " + names[static_cast<std::size_t>(worst)] + " from the other parameters");
}

}  // namespace

Estimate scaled(const Estimate& e, double factor) {
    return {.value = e.value * factor, .deviation = e.deviation * factor, .low = e.low * factor, .high = e.high * factor};
}

Estimate Fit::combination(const VectorXd& gradient, int of) const {
    const double value = gradient.dot(theta);
    const double deviation = std::sqrt(std::max(gradient.dot(covariance * gradient), 0.0));
    const double half = widen * boost::math::quantile(boost::math::normal(), 1.0 - 0.025 / of) * deviation;
    return {.value = value, .deviation = deviation, .low = value - half, .high = value + half};
}

Estimate Fit::estimate(Index i, int of) const {
    return combination(VectorXd::Unit(theta.size(), i), of);
}

Fit fit(const LeastSquares& problem, std::span<const std::string> names, const Residuals& residuals) {
    constexpr double kSmallestStep = 1e-5;  // of the scale, Euclidean
    constexpr double kHopeless = 1e12;
    Fit out;
    out.theta = problem.start.cwiseMax(problem.min).cwiseMin(problem.max);
    residuals(out.theta, out.residuals);
    double cost = out.residuals.squaredNorm();
    double damping = 1e-3;
    MatrixXd j = jacobian(problem, residuals, out.theta, out.residuals.size());
    VectorXd trial_residuals(out.residuals.size());
    for (; out.iterations < problem.max_iterations && !out.converged; ++out.iterations) {
        const MatrixXd normal = j.transpose() * j;
        const VectorXd gradient = j.transpose() * out.residuals;
        bool better = false;
        while (!better && damping < kHopeless) {
            MatrixXd damped = normal;
            damped.diagonal() += damping * (normal.diagonal().array() + 1e-12 * normal.trace()).matrix();
            const VectorXd step = -damped.ldlt().solve(gradient);
            const VectorXd trial = (out.theta + step.cwiseProduct(problem.scale)).cwiseMax(problem.min).cwiseMin(problem.max);
            residuals(trial, trial_residuals);
            const double trial_cost = trial_residuals.squaredNorm();
            const double moved = (trial - out.theta).cwiseQuotient(problem.scale).norm();
            if (trial_cost < cost) {
                out.theta = trial;
                out.residuals = trial_residuals;
                cost = trial_cost;
                damping *= 0.1;
                better = true;
            } else {
                damping *= 10.0;
            }
            if (moved < kSmallestStep) {
                out.converged = true;
                break;
            }
        }
        if (!better) {
            out.converged = true;
            break;
        }
        j = jacobian(problem, residuals, out.theta, out.residuals.size());
    }
    const MatrixXd normal = j.transpose() * j;
    check_information(normal, names);
    const MatrixXd bread = normal.ldlt().solve(MatrixXd::Identity(normal.rows(), normal.cols()));
    const MatrixXd scores = problem.whitened ? MatrixXd(out.residuals) : batched_scores(j, out.residuals, problem.batch);
    out.lags = lags_for(scores);
    const MatrixXd middle = problem.whitened ? long_run_of_stationary(j, out.residuals, out.lags) : long_run(scores, out.lags);
    const auto n = static_cast<double>(out.residuals.size());
    const auto p = static_cast<double>(out.theta.size());
    const MatrixXd unit = bread * middle * bread * (n / std::max(n - p, 1.0));
    out.covariance = problem.scale.asDiagonal() * unit * problem.scale.asDiagonal();
    // Kiefer and Vogelsang: critical value of the Bartlett window with lags b n, as a polynomial, two-sided 5 %.
    const double b = static_cast<double>(out.lags) / static_cast<double>(scores.rows());
    out.widen = (1.9600 + b * (2.9694 + b * (0.4160 - b * 0.5324))) / 1.9600;
    out.rms = std::sqrt(cost / n);
    const Index last = out.residuals.size() - 1;
    out.first_correlation = cost > 0.0 ? out.residuals.head(last).dot(out.residuals.tail(last)) / cost : 0.0;
    return out;
}

}  // namespace identification
