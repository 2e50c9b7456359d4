/// Eigenvalues and exponentials of dense matrices, by Eigen. A unit of its own, since Eigen's templates take longer to compile than their users.
#pragma once

#include <Eigen/Core>

#include <complex>
#include <vector>

namespace study::margins {

/// Eigenvalues of a square matrix, in no order. Throws std::runtime_error if the iteration does not converge.
[[nodiscard]] std::vector<std::complex<double>> eigenvalues(const Eigen::MatrixXd& matrix);
[[nodiscard]] std::vector<std::complex<double>> eigenvalues(const Eigen::MatrixXcd& matrix);

[[nodiscard]] Eigen::MatrixXd exponential(const Eigen::MatrixXd& matrix);

}  // namespace study::margins
