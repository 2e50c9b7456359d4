/// A linear periodic loop: a controller that acts once a period, and a sensor with a new reading only in every N-th.
#pragma once

#include <Eigen/Core>

#include "plant_sim/study/margins/loop.hpp"

namespace study::margins {

/// x(k+1) = A(k) x(k) + B w(k), u(k) = C(k) x(k), with period N in k; closed by w = u, opened for L = -(transfer from w to u).
struct PeriodicSystem {
    std::vector<Eigen::MatrixXd> a;  ///< N matrices, as many as `c`
    Eigen::VectorXd b;
    std::vector<Eigen::RowVectorXd> c;
    double period_s = 0.0;
    Eigen::Index controller_states = 0;  ///< number of the controller's states, which are first in x
};

class SampledLoop final : public Loop {
  public:
    /// Throws std::invalid_argument if sizes do not match.
    explicit SampledLoop(const PeriodicSystem& system);

    void at(Complex s, std::vector<Complex>& loci) const override;
    [[nodiscard]] int unstable_poles() const override { return unstable_poles_; }
    [[nodiscard]] double end_radps() const override;
    /// From the loci half-way and at `to`, doubled, for steps not longer than the distance to L's nearest pole. This is no strict bound; wherever it
    /// is used, the count is checked against the eigenvalues of the closed loop.
    [[nodiscard]] double max_approach(Complex from, Complex to, const std::vector<Complex>& loci) const override;

    /// Response to a sine w(k) = e^{j w k h} at its own frequency: L as a frequency analyser measures it.
    [[nodiscard]] Complex response(double frequency_radps) const;

    /// Closed-loop poles for the loop's gain times `gain`, as growth rates 1/s (real part) and frequencies rad/s, the most unstable first; from the
    /// monodromy matrix, without Nyquist.
    [[nodiscard]] std::vector<Complex> closed_poles(double gain = 1.0) const;
    [[nodiscard]] std::size_t loci() const { return system_.a.size(); }

  private:
    [[nodiscard]] Eigen::MatrixXcd lifted(Complex s) const;

    PeriodicSystem system_;
    Eigen::MatrixXd hessenberg_, into_, out_, through_;  // of the system lifted over its N periods
    std::vector<Complex> poles_;                         // of the lifted system
    int unstable_poles_ = 0;
};

/// Fastest growth, 1/s, of the controller alone with constant sensor values: eigenvalues of its part of A(k), which then depends on no state of the
/// plant. A law that grows may be stable in the closed loop, but it runs away when its commands have no effect: at a limit of the valve, or when it
/// is fed with a recording.
[[nodiscard]] double controller_growth_per_s(const PeriodicSystem& system);
/// A controller that grows no faster counts as stable: these are its integrals, of slip and of the valve's offset.
inline constexpr double kIntegrates_per_s = 0.1;

}  // namespace study::margins
