#include "plant_sim/study/margins/sampled_loop.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "plant_sim/study/margins/dense.hpp"

namespace study::margins {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

constexpr double kGone = 1e-9;  // a smaller eigenvalue belongs to a delay line that has emptied

/// Solves (z I - H) X = B for upper Hessenberg H.
MatrixXcd solve_hessenberg(const MatrixXd& h, Complex z, const MatrixXd& b) {
    const Index n = h.rows();
    MatrixXcd m = -h.cast<Complex>();
    m.diagonal().array() += z;
    MatrixXcd x = b.cast<Complex>();
    for (Index i = 0; i + 1 < n; ++i) {
        if (std::abs(m(i + 1, i)) > std::abs(m(i, i))) {
            m.row(i).tail(n - i).swap(m.row(i + 1).tail(n - i));
            x.row(i).swap(x.row(i + 1));
        }
        if (m(i, i) == 0.0) continue;  // the whole column is zero: z is a pole, and the division below gives infinity
        const Complex f = m(i + 1, i) / m(i, i);
        if (f == 0.0) continue;
        m.row(i + 1).tail(n - i) -= f * m.row(i).tail(n - i);
        x.row(i + 1) -= f * x.row(i);
    }
    m.triangularView<Eigen::Upper>().solveInPlace(x);
    return x;
}

/// As growth rate and frequency, the most unstable first, without those of empty delay lines.
std::vector<Complex> rates(const MatrixXd& monodromy, double h) {
    std::vector<Complex> s;
    const std::vector<Complex> values = eigenvalues(monodromy);
    s.reserve(values.size());
    for (const Complex& v : values)
        if (std::abs(v) > kGone) s.push_back(std::log(v) / h);
    std::sort(s.begin(), s.end(), [](Complex a, Complex b) { return a.real() != b.real() ? a.real() > b.real() : a.imag() > b.imag(); });
    return s;
}

}  // namespace

SampledLoop::SampledLoop(const PeriodicSystem& system) : system_(system) {
    const std::size_t n = system.a.size();
    if (n == 0 || system.c.size() != n || !(system.period_s > 0.0))
        throw std::invalid_argument("a periodic system needs as many matrices A as rows C, and a period");
    const Index states = system.b.size();
    const auto columns = static_cast<Index>(n);
    MatrixXd monodromy = MatrixXd::Identity(states, states);
    MatrixXd b = MatrixXd::Zero(states, columns);
    MatrixXd c(columns, states);
    through_ = MatrixXd::Zero(columns, columns);
    for (Index i = 0; i < columns; ++i) {
        const auto k = static_cast<std::size_t>(i);
        if (system.a[k].rows() != states || system.a[k].cols() != states || system.c[k].size() != states)
            throw std::invalid_argument("matrices of a periodic system differ in size");
        c.row(i) = system.c[k] * monodromy;
        through_.row(i) = system.c[k] * b;
        b = (system.a[k] * b).eval();
        b.col(i) += system.b;
        monodromy = (system.a[k] * monodromy).eval();
    }
    const Eigen::HessenbergDecomposition<MatrixXd> decomposition(monodromy);
    const MatrixXd q = decomposition.matrixQ();
    hessenberg_ = decomposition.matrixH();
    into_ = q.transpose() * b;
    out_ = c * q;
    poles_ = rates(monodromy, system.period_s * static_cast<double>(n));
    unstable_poles_ =
        static_cast<int>(std::count_if(poles_.begin(), poles_.end(), [](Complex s) { return s.real() > 0.0 && std::abs(s) > kIndent_radps; }));
}

double SampledLoop::end_radps() const {
    return std::numbers::pi / (system_.period_s * static_cast<double>(system_.a.size()));
}

MatrixXcd SampledLoop::lifted(Complex s) const {
    const Complex z = std::exp(s * system_.period_s * static_cast<double>(system_.a.size()));
    return -(through_.cast<Complex>() + out_.cast<Complex>() * solve_hessenberg(hessenberg_, z, into_));
}

void SampledLoop::at(Complex s, std::vector<Complex>& loci) const {
    const MatrixXcd l = lifted(s);
    if (l.size() == 1) {
        loci.assign(1, l(0, 0));
        return;
    }
    loci = eigenvalues(l);
}

double SampledLoop::max_approach(Complex from, Complex to, const std::vector<Complex>& loci) const {
    // Beyond the nearest pole of L there may be a resonance that is visible neither half-way nor at the end.
    const double reach = std::abs(to - from);
    for (const Complex& pole : poles_)
        if (reach > std::abs(from - pole)) return std::numeric_limits<double>::infinity();
    std::vector<Complex> there;
    double max = 0.0;
    for (const Complex s : {0.5 * (from + to), to}) {
        at(s, there);
        for (const Complex l : loci) {
            double nearest = std::numeric_limits<double>::infinity();
            for (const Complex t : there) nearest = std::min(nearest, std::abs(t - l));
            max = std::max(max, nearest / std::abs(1.0 + l));
        }
    }
    return 2.0 * max;
}

Complex SampledLoop::response(double frequency_radps) const {
    const Complex turn(0.0, frequency_radps * system_.period_s);
    const MatrixXcd l = lifted({0.0, frequency_radps});
    Complex sum = 0.0;
    for (Index i = 0; i < l.rows(); ++i)
        for (Index j = 0; j < l.cols(); ++j) sum += l(i, j) * std::exp(turn * static_cast<double>(j - i));
    return sum / static_cast<double>(l.rows());
}

std::vector<Complex> SampledLoop::closed_poles(double gain) const {
    MatrixXd monodromy = MatrixXd::Identity(system_.b.size(), system_.b.size());
    for (std::size_t i = 0; i < system_.a.size(); ++i) monodromy = ((system_.a[i] + gain * system_.b * system_.c[i]) * monodromy).eval();
    return rates(monodromy, system_.period_s * static_cast<double>(system_.a.size()));
}

double controller_growth_per_s(const PeriodicSystem& system) {
    const Index n = system.controller_states;
    MatrixXd monodromy = MatrixXd::Identity(n, n);
    for (const MatrixXd& a : system.a) monodromy = (a.topLeftCorner(n, n) * monodromy).eval();
    return rates(monodromy, system.period_s * static_cast<double>(system.a.size())).front().real();
}

}  // namespace study::margins
