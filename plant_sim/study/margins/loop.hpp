/// Open loops L(s) of unity negative feedback, as Nyquist's criterion needs them.
#pragma once

#include <complex>
#include <vector>

namespace study::margins {

using Complex = std::complex<double>;

/// A loop whose closed-loop poles are the zeros of 1 + L. A loop that does different things in successive periods (a sensor that has news
/// only in every N-th) has N of them, the characteristic loci: eigenvalues of the loop lifted over N periods. One is what an ordinary
/// loop has.
class Loop {
  public:
    Loop() = default;
    Loop(const Loop&) = default;
    Loop(Loop&&) = default;
    Loop& operator=(const Loop&) = default;
    Loop& operator=(Loop&&) = default;
    virtual ~Loop() = default;

    /// Poles and closed-loop poles nearer to s = 0 than this count as stable: integrators are passed on the right.
    static constexpr double kIndent_radps = 1e-2;

    /// A loop below this (-60 dB) is nobody's margin.
    static constexpr double kNothing = 1e-3;

    /// The loci at `s`, in any order; always the same number of them. A sampled loop takes z = e^{s h}.
    virtual void at(Complex s, std::vector<Complex>& loci) const = 0;
    /// Poles of L with a positive real part, beyond the indent.
    [[nodiscard]] virtual int unstable_poles() const = 0;
    /// Upper end of the axis: the Nyquist frequency of a sampled loop; elsewhere a frequency beyond which |L| < kNothing for certain.
    [[nodiscard]] virtual double end_radps() const = 0;
    /// How far a locus may move between `from` (where they are `loci`) and `to`, at most, as a share of its distance to -1 at `from`: the
    /// largest of all loci. Infinite where nothing can be said, which asks for a shorter way.
    [[nodiscard]] virtual double max_approach(Complex from, Complex to, const std::vector<Complex>& loci) const = 0;
};

/// k prod(s - z) / prod(s - p) e^{-tau s}, more poles than zeros; the delay is exact.
class DelayLoop final : public Loop {
  public:
    /// Throws std::invalid_argument unless there are more poles than zeros, all in conjugate pairs or real, and no delay below zero.
    DelayLoop(double gain, std::vector<Complex> zeros, std::vector<Complex> poles, double delay_s);

    [[nodiscard]] Complex value(Complex s) const;
    void at(Complex s, std::vector<Complex>& loci) const override { loci.assign(1, value(s)); }
    [[nodiscard]] int unstable_poles() const override;
    [[nodiscard]] double end_radps() const override { return end_radps_; }
    /// Rigorous: a bound on the derivative over the straight way.
    [[nodiscard]] double max_approach(Complex from, Complex to, const std::vector<Complex>& loci) const override;

  private:
    double gain_;
    std::vector<Complex> zeros_, poles_;
    double delay_s_;
    double end_radps_;
};

}  // namespace study::margins
