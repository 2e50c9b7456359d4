/// Open loops L(s) of unity negative feedback, as Nyquist's criterion needs them.
#pragma once

#include <complex>
#include <vector>

namespace study::margins {

using Complex = std::complex<double>;

/// A loop whose closed-loop poles are the zeros of 1 + L. A loop that varies with a period of N sampling periods (a sensor with a new reading only in
/// every N-th) has N characteristic loci: the eigenvalues of the loop lifted over N periods. An ordinary loop has one.
class Loop {
  public:
    Loop() = default;
    Loop(const Loop&) = default;
    Loop(Loop&&) = default;
    Loop& operator=(const Loop&) = default;
    Loop& operator=(Loop&&) = default;
    virtual ~Loop() = default;

    /// Poles and closed-loop poles nearer to s = 0 than this count as stable: the contour passes integrators on the right.
    static constexpr double kIndent_radps = 1e-2;

    /// A loop gain below this (-60 dB) affects no margin.
    static constexpr double kNothing = 1e-3;

    /// Sets `loci` to the loci at `s`, in any order; their number never changes. A sampled loop uses z = e^{s h}.
    virtual void at(Complex s, std::vector<Complex>& loci) const = 0;
    /// Number of poles of L with a positive real part, outside of the indent.
    [[nodiscard]] virtual int unstable_poles() const = 0;
    /// Upper end of the axis: the Nyquist frequency of a sampled loop; otherwise a frequency beyond which certainly |L| < kNothing.
    [[nodiscard]] virtual double end_radps() const = 0;
    /// Upper bound of the motion of any locus between `from`, where they are `loci`, and `to`, relative to its distance to -1 at `from`. Infinite if
    /// there is no bound; the caller then takes a shorter step.
    [[nodiscard]] virtual double max_approach(Complex from, Complex to, const std::vector<Complex>& loci) const = 0;
};

/// k prod(s - z) / prod(s - p) e^{-tau s}, with more poles than zeros and an exact delay.
class DelayLoop final : public Loop {
  public:
    /// Throws std::invalid_argument unless there are more poles than zeros, all of them real or in conjugate pairs, and the delay is not negative.
    DelayLoop(double gain, std::vector<Complex> zeros, std::vector<Complex> poles, double delay_s);

    [[nodiscard]] Complex value(Complex s) const;
    void at(Complex s, std::vector<Complex>& loci) const override { loci.assign(1, value(s)); }
    [[nodiscard]] int unstable_poles() const override;
    [[nodiscard]] double end_radps() const override { return end_radps_; }
    /// Rigorous: by a bound of the derivative on the straight line.
    [[nodiscard]] double max_approach(Complex from, Complex to, const std::vector<Complex>& loci) const override;

  private:
    double gain_;
    std::vector<Complex> zeros_, poles_;
    double delay_s_;
    double end_radps_;
};

}  // namespace study::margins
