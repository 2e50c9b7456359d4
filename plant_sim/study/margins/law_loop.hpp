/// The shipped law as a linear loop: what control::Estimator, control::SlipLaw and the plant do to small motions around an equilibrium.
///
/// Opened at the valve current, period by period, exact: the plant's wheel and valve as sampled, its delay in whole and broken periods; the
/// controller's valve model with the commands in its pipe, its observer, its outlook over the delay, the law. An encoder whose edges are
/// further apart than a period gives news only in every N-th, N = round(T_edge / h): the loop is periodic then, and margins() takes its N
/// characteristic loci. Factor in front of L: an error of valve gain, brake gain (to first order) or current map.
///
/// The observer is one that has settled and knows the road's answer: the wheel's pole. Neglected: how it learns that, and forgets it; limits
/// of pressure, slip rate and integral, the retreat of the reference and its rate limit; noise, jitter and rounding; the
/// motion of the aircraft's speed and of its estimate; changes of load, radius and k_b while the loop settles; an edge interval that
/// is no whole number of periods (rounded) and its beat with the period; edges bound to the angle instead of time.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "firmware/control/config.hpp"
#include "plant_sim/study/margins/loop.hpp"
#include "plant_sim/study/margins/operating_point.hpp"

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
    /// By what the loci do half the way and the whole way, doubled: no bound, but the count is checked against the eigenvalues of the closed
    /// loop wherever it is used.
    [[nodiscard]] double most_approach(Complex from, Complex to,
                                       const std::vector<Complex>& loci) const override;

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
    int unstable_poles_ = 0;
};

/// Fastest growth, 1/s, of the controller by itself, its sensors held: eigenvalues of its own part of A(k), which no state of the plant enters
/// then. A law that grows may be stable in the closed loop all the same, but only as long as its commands come back to it: at a limit of the
/// valve, or fed with a recording, it runs away.
[[nodiscard]] double controller_growth_per_s(const PeriodicSystem& system);
/// A controller that grows no faster is stable by itself: those are its integrals, of slip and of the valve's offset.
inline constexpr double kIntegrates_per_s = 0.1;

/// Linearised at `at`: `config` is the controller, `rig` the plant. `answer_per_s` is what the observer takes the road's answer for: the
/// wheel's pole, unless given.
[[nodiscard]] PeriodicSystem law_system(const antiskid::control::Config& config,
                                        const plant::RigParameters& rig, const OperatingPoint& at,
                                        Linearisation linearisation, std::optional<double> answer_per_s = {});

/// falling_reference() of slip_law.hpp.
[[nodiscard]] double scheduled_slip(const antiskid::control::SlipConfig& config, double slip_reference,
                                    double speed_mps);

}  // namespace study::margins
