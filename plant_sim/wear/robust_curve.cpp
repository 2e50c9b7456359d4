#include "plant_sim/wear/robust_curve.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "plant_sim/study/order_statistics.hpp"

namespace wear {

namespace {

using Eigen::Vector3d;

// Both have 95 % of least squares' efficiency on normal residuals (Huber 1981; Beaton and Tukey 1974).
constexpr double kHuber = 1.345;
constexpr double kBisquare = 4.685;
constexpr double kMadToDeviation = 1.4826;
/// Data without any scatter still need a unit for their residuals.
constexpr double kMinScale = 1e-9;

double huber_weight(double u) {
    return std::abs(u) <= kHuber ? 1.0 : kHuber / std::abs(u);
}

double bisquare_weight(double u) {
    const double q = 1.0 - (u / kBisquare) * (u / kBisquare);
    return q > 0.0 ? q * q : 0.0;
}

double bisquare_loss(double u) {
    const double q = 1.0 - (u / kBisquare) * (u / kBisquare);
    return q > 0.0 ? 1.0 - q * q * q : 1.0;
}

double curve_at(const Vector3d& b, double x) {
    return 1.0 + b.dot(centred_powers(x));
}

/// mu / f by stop, its median.
std::vector<double> median_means(const std::vector<const CurveSample*>& samples, std::size_t stops, const Vector3d& b) {
    std::vector<std::vector<double>> ratios(stops);
    for (const CurveSample* s : samples) ratios[s->stop].push_back(s->mu / curve_at(b, s->x));
    std::vector<double> out(stops);
    for (std::size_t i = 0; i < stops; ++i) out[i] = study::median(std::move(ratios[i]));
    return out;
}

double residual(const CurveSample& s, double mean, const Vector3d& b) {
    return s.mu / mean - curve_at(b, s.x);
}

double scale_of(const std::vector<const CurveSample*>& samples, const CurveFit& fit) {
    std::vector<double> sizes;
    sizes.reserve(samples.size());
    for (const CurveSample* s : samples) sizes.push_back(std::abs(residual(*s, fit.means[s->stop], fit.b)));
    return std::max(kMadToDeviation * study::median(std::move(sizes)), kMinScale);
}

/// One step of weighted least squares: b given the means, then the means given b. Returns the greatest relative change.
template <typename Weight>
double step(const std::vector<const CurveSample*>& samples, std::size_t order, Weight weight, CurveFit& fit) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Vector3d right = Vector3d::Zero();
    std::vector<double> weights(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const CurveSample& s = *samples[i];
        const double w = weight(residual(s, fit.means[s.stop], fit.b) / fit.scale);
        weights[i] = w;
        const Vector3d p = centred_powers(s.x);
        normal.noalias() += w * p * p.transpose();
        right += w * (s.mu / fit.means[s.stop] - 1.0) * p;
    }
    double change = 0.0;
    if (order > 0) {
        const auto n = static_cast<Eigen::Index>(order);
        const Eigen::VectorXd b = normal.topLeftCorner(n, n).ldlt().solve(right.head(n));
        change = (b - fit.b.head(n)).cwiseAbs().maxCoeff();
        fit.b.head(n) = b;
    }
    std::vector<std::array<double, 2>> sums(fit.means.size(), {0.0, 0.0});
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const CurveSample& s = *samples[i];
        const double f = curve_at(fit.b, s.x);
        sums[s.stop][0] += weights[i] * f * s.mu;
        sums[s.stop][1] += weights[i] * f * f;
    }
    for (std::size_t j = 0; j < sums.size(); ++j) {
        if (!(sums[j][1] > 0.0)) continue;
        const double mean = sums[j][0] / sums[j][1];
        change = std::max(change, std::abs(mean / fit.means[j] - 1.0));
        fit.means[j] = mean;
    }
    return change;
}

}  // namespace

Vector3d centred_powers(double x) {
    return {x - 1.0 / 2.0, x * x - 1.0 / 3.0, x * x * x - 1.0 / 4.0};
}

CurveFit fit_curve(const std::vector<CurveSample>& samples, std::size_t stops, std::size_t order, std::optional<std::size_t> without) {
    constexpr int kHuberSteps = 30;
    constexpr int kBisquareSteps = 200;
    constexpr double kConverged = 1e-8;
    std::vector<const CurveSample*> used;
    used.reserve(samples.size());
    for (const CurveSample& s : samples)
        if (s.group != without) used.push_back(&s);
    CurveFit fit;
    fit.means = median_means(used, stops, fit.b);
    for (int i = 0; i < kHuberSteps; ++i) {
        fit.scale = scale_of(used, fit);
        if (step(used, order, huber_weight, fit) < kConverged) break;
    }
    // Bisquare has local optima where the scale may move with it: it keeps that of Huber's solution.
    fit.scale = scale_of(used, fit);
    for (int i = 0; i < kBisquareSteps; ++i)
        if (step(used, order, bisquare_weight, fit) < kConverged) break;
    return fit;
}

double loss_of_group(const std::vector<CurveSample>& samples, std::size_t stops, std::size_t group, const Vector3d& b, double scale) {
    constexpr int kSteps = 20;
    std::vector<const CurveSample*> members;
    for (const CurveSample& s : samples)
        if (s.group == group) members.push_back(&s);
    CurveFit fit;
    fit.b = b;
    fit.scale = scale;
    fit.means = median_means(members, stops, b);
    for (int i = 0; i < kSteps; ++i) (void)step(members, 0, bisquare_weight, fit);
    double sum = 0.0;
    for (const CurveSample* s : members) sum += bisquare_loss(residual(*s, fit.means[s->stop], b) / scale);
    return sum / static_cast<double>(members.size());
}

std::vector<double> rejected_shares(const std::vector<CurveSample>& samples, const CurveFit& fit) {
    std::vector<double> rejected(fit.means.size(), 0.0);
    std::vector<double> all(fit.means.size(), 0.0);
    for (const CurveSample& s : samples) {
        all[s.stop] += 1.0;
        if (bisquare_weight(residual(s, fit.means[s.stop], fit.b) / fit.scale) <= 0.0) rejected[s.stop] += 1.0;
    }
    for (std::size_t i = 0; i < all.size(); ++i) rejected[i] /= std::max(all[i], 1.0);
    return rejected;
}

}  // namespace wear
