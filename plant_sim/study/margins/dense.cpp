#include "plant_sim/study/margins/dense.hpp"

#include <Eigen/Eigenvalues>
#include <stdexcept>
#include <unsupported/Eigen/MatrixFunctions>

namespace study::margins {

namespace {

template <typename Solver>
std::vector<std::complex<double>> values(const Solver& solver) {
    if (solver.info() != Eigen::Success) throw std::runtime_error("eigenvalues: no convergence");
    return {solver.eigenvalues().begin(), solver.eigenvalues().end()};
}

}  // namespace

std::vector<std::complex<double>> eigenvalues(const Eigen::MatrixXd& matrix) {
    return values(Eigen::EigenSolver<Eigen::MatrixXd>(matrix, false));
}

std::vector<std::complex<double>> eigenvalues(const Eigen::MatrixXcd& matrix) {
    return values(Eigen::ComplexEigenSolver<Eigen::MatrixXcd>(matrix, false));
}

Eigen::MatrixXd exponential(const Eigen::MatrixXd& matrix) {
    return matrix.exp();
}

}  // namespace study::margins
