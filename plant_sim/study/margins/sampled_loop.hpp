/// A loop that a controller closes once a period, with a sensor that has news only in every N-th: linear and periodic.
#pragma once

#include <Eigen/Core>

#include "plant_sim/study/margins/loop.hpp"

namespace study::margins {

/// x(k+1) = A(k) x(k) + B w(k), u(k) = C(k) x(k), of period N in k; closed by w = u. Opened for L = -(transfer from w to u).
struct PeriodicSystem {
    std::vector<Eigen::MatrixXd> a;  ///< N of them, as many as `c`
    Eigen::VectorXd b;
    std::vector<Eigen::RowVectorXd> c;
    double period_s = 0.0;
    Eigen::Index controller_states = 0;  ///< the first of x: what the controller remembers
};

class SampledLoop final : public Loop {
  public:
    /// Throws std::invalid_argument where sizes do not fit.
    explicit SampledLoop(const PeriodicSystem& system);

    void at(Complex s, std::vector<Complex>& loci) const override;
    [[nodiscard]] int unstable_poles() const override { return unstable_poles_; }
    [[nodiscard]] double end_radps() const override;
    /// By what the loci do half the way and the whole way, doubled, on ways no longer than to L's nearest pole: no bound, but the count is checked
    /// against the eigenvalues of the closed loop wherever it is used.
    [[nodiscard]] double max_approach(Complex from, Complex to, const std::vector<Complex>& loci) const override;

    /// The answer at the frequency of the question, of a sine w(k) = e^{j w k h}: what a frequency analyser measures of L.
    [[nodiscard]] Complex response(double frequency_radps) const;

    /// Closed-loop poles with the loop's gain times `gain`, as growth rates 1/s (real part) and frequencies rad/s, the most
    /// unstable first: from the monodromy matrix, without Nyquist.
    [[nodiscard]] std::vector<Complex> closed_poles(double gain = 1.0) const;
    [[nodiscard]] std::size_t loci() const { return system_.a.size(); }

  private:
    [[nodiscard]] Eigen::MatrixXcd lifted(Complex s) const;

    PeriodicSystem system_;
    Eigen::MatrixXd hessenberg_, into_, out_, through_;  // of the system lifted over its N periods
    std::vector<Complex> poles_;                         // of the same
    int unstable_poles_ = 0;
};

/// Fastest growth, 1/s, of the controller by itself, its sensors held: eigenvalues of its own part of A(k), which no state of the plant enters
/// then. A law that grows may be stable in the closed loop all the same, but only as long as its commands come back to it: at a limit of the
/// valve, or fed with a recording, it runs away.
[[nodiscard]] double controller_growth_per_s(const PeriodicSystem& system);
/// A controller that grows no faster is stable by itself: those are its integrals, of slip and of the valve's offset.
inline constexpr double kIntegrates_per_s = 0.1;

}  // namespace study::margins
