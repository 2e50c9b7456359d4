/// Robust regression of mu = mean_s (1 + sum b_k (x^k - 1 / (k + 1))), with b common to all stops and a mean for each.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <vector>

namespace wear {

struct CurveSample {
    double x = 0.0;
    double mu = 0.0;
    std::size_t stop = 0;
    std::size_t group = 0;
};

/// x^k - 1 / (k + 1) for k = 1 to 3.
[[nodiscard]] Eigen::Vector3d centred_powers(double x);

struct CurveFit {
    Eigen::Vector3d b = Eigen::Vector3d::Zero();  ///< 0 above the order
    std::vector<double> means;                    ///< by stop; 0 for a stop without samples
    double scale = 0.0;                           ///< of the relative residuals mu / (mean f) - 1, from their median
};

/// `without`: a group to leave out.
[[nodiscard]] CurveFit fit_curve(const std::vector<CurveSample>& samples, std::size_t stops, std::size_t order,
                                 std::optional<std::size_t> without = std::nullopt);

/// Mean bisquare loss of the samples of `group` about the curve, with the best mean for each stop and residuals in units of `scale`.
[[nodiscard]] double loss_of_group(const std::vector<CurveSample>& samples, std::size_t stops, std::size_t group, const Eigen::Vector3d& b,
                                   double scale);

/// Share of each stop's samples with bisquare weight 0.
[[nodiscard]] std::vector<double> rejected_shares(const std::vector<CurveSample>& samples, const CurveFit& fit);

}  // namespace wear
