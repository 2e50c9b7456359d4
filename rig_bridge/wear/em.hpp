/// One run of expectation-maximisation on standardised data: the inner loop of fit.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace wear {

constexpr std::size_t kMaxComponents = 15;
constexpr std::size_t kMaxSearched = kMaxComponents + 1;  ///< one more than requested: merging two of its components gives starting points
constexpr std::size_t kBlock = 64;                        ///< points processed together

/// Two-dimensional points, each coordinate of mean 0 and standard deviation 1, one array per coordinate, padded to whole blocks.
class StandardPoints {
  public:
    /// `x` and `y` of equal length, at least one.
    StandardPoints(std::span<const double> x, std::span<const double> y);

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] std::size_t blocks() const { return x_.size() / kBlock; }
    [[nodiscard]] const double* x() const { return x_.data(); }
    [[nodiscard]] const double* y() const { return y_.data(); }
    /// 1 for a point, 0 for padding.
    [[nodiscard]] const double* there() const { return there_.data(); }

  private:
    std::size_t size_;
    std::vector<double> x_;
    std::vector<double> y_;
    std::vector<double> there_;
};

/// M Gaussian components on standardised coordinates.
struct StandardMixture {
    std::size_t components = 0;
    std::array<double, kMaxSearched> weight{}, mx{}, my{}, xx{}, xy{}, yy{};
};

struct EmSettings {
    double tolerance = 1e-8;  ///< ends if a cycle of three steps improves the log-likelihood by less than this per point
    /// Least eigenvalue of a covariance matrix on standardised data. Under this bound the M step stays the exact maximum (eigenvalues
    /// below it are raised to it), so that the log-likelihood never falls and no component collapses onto a point or a line.
    double covariance_floor = 1e-4;
    int max_iterations = 20000;
};

struct EmRun {
    StandardMixture mixture;
    double log_likelihood = 0.0;  ///< of `mixture` before the last M step, which can only increase it
    int iterations = 0;           ///< EM steps
    int refused = 0;              ///< of these, extrapolations rejected because the likelihood fell
    bool converged = false;
};

/// From `start` to convergence, by SQUAREM (Varadhan and Roland, Scand. J. Statist. 35, 2008, scheme S3): after two EM steps the parameters are
/// extrapolated and a third step begins there, unless the extrapolation is less likely than what it began from. The bound on eigenvalues also applies
/// to the extrapolation. `watch`, if given, is called with the log-likelihood of each accepted step, which never decreases. Bit-identical on every
/// machine, whatever its vector unit.
[[nodiscard]] EmRun em(const StandardPoints& points, const StandardMixture& start, const EmSettings& settings,
                       const std::function<void(double)>& watch = {});

/// The mixture in which each component is fitted to the points that `label` assigns to it (0 .. components - 1, one a point), covariances raised by
/// 0.01.
[[nodiscard]] StandardMixture mixture_of(const StandardPoints& points, std::span<const std::size_t> label, std::size_t components,
                                         double covariance_floor);

/// Log-likelihood of the points.
[[nodiscard]] double log_likelihood(const StandardPoints& points, const StandardMixture& mixture);

}  // namespace wear
