/// Eq. (6) by itself, in double precision with small steps: what the controller's valve model is judged by, and the pressure of the bench.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace control_test {

class ValveTruth {
  public:
    static constexpr double kStep_s = 2.5e-5;

    ValveTruth(const double omega_n, const double xi, const double delay_s)
        : w_(omega_n), xi_(xi), pipe_(static_cast<std::size_t>(std::llround(delay_s / kStep_s)) + 1, 0.0) {}

    /// Holds `static_Pa` at the valve's entry for `h` seconds; `each(pressure, step)` is called after every small step.
    template <typename Each>
    void hold(const double static_Pa, const double h, const Each& each) {
        const auto steps = static_cast<int>(std::llround(h / kStep_s));
        for (int i = 0; i < steps; ++i) {
            pipe_[at_] = static_Pa;
            at_ = (at_ + 1) % pipe_.size();
            advance(pipe_[at_]);
            each(p_, kStep_s);
        }
    }
    void hold(const double static_Pa, const double h) {
        hold(static_Pa, h, [](double, double) {});
    }

    [[nodiscard]] double pressure_Pa() const { return p_; }
    [[nodiscard]] double rate_Paps() const { return r_; }

  private:
    void advance(const double u) {
        const auto f = [&](const double p, const double r) { return w_ * w_ * (u - p) - 2.0 * xi_ * w_ * r; };
        constexpr double h = kStep_s;
        const double p1 = r_, r1 = f(p_, r_);
        const double p2 = r_ + 0.5 * h * r1, r2 = f(p_ + 0.5 * h * p1, r_ + 0.5 * h * r1);
        const double p3 = r_ + 0.5 * h * r2, r3 = f(p_ + 0.5 * h * p2, r_ + 0.5 * h * r2);
        const double p4 = r_ + h * r3, r4 = f(p_ + h * p3, r_ + h * r3);
        p_ += h / 6.0 * (p1 + 2.0 * p2 + 2.0 * p3 + p4);
        r_ += h / 6.0 * (r1 + 2.0 * r2 + 2.0 * r3 + r4);
    }

    double w_, xi_;
    std::vector<double> pipe_;  // ring; the oldest entry acts
    std::size_t at_ = 0;
    double p_ = 0.0, r_ = 0.0;
};

}  // namespace control_test
