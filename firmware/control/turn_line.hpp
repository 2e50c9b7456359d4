/// The part of a signal that returns with every turn of the wheel: brake discs that are not true make it, and eccentric encoders.
///
/// An adaptive canceller with the wheel's own angle as reference (B. Widrow and S. D. Stearns, Adaptive Signal Processing, 1985, chapter 12); its two
/// amplitudes are kept turned to the present angle, which needs no reference (J. R. Glover, IEEE Trans. ASSP-25, 1977, p. 484: it is a notch). A
/// line that may come from chance is left in the signal.
#pragma once

namespace antiskid::control {

class TurnLine {
  public:
    /// `signal` without its line, and learns from it. The wheel turned by `angle_rad` in the `since_s` since the last call; more than 1 rad is a gap,
    /// in which the line's phase is lost. The line is some rad/s wide: not to be called where the wheel turns as slowly as that.
    [[nodiscard]] float without(float signal, float angle_rad, float since_s) {
        constexpr float kWidth_radps = 3.0F;
        constexpr float kChance = 0.3F;  // square of the line, over the rest's power, that noise and the loop's own motion give
        if (angle_rad > kMaxAngle_rad) *this = {};
        const float square = angle_rad * angle_rad;
        const float c = 1.0F - 0.5F * square * (1.0F - square * (1.0F / 12.0F)), s = angle_rad * (1.0F - square * (1.0F / 6.0F));
        const float line = line_ * c - quadrature_ * s;
        quadrature_ = line_ * s + quadrature_ * c;
        const float rest = signal - line;
        const float step = 2.0F * kWidth_radps * since_s;
        line_ = line + step * rest;
        rest_power_ += (rest * rest - rest_power_) * step;
        return line_ * line_ + quadrature_ * quadrature_ > kChance * rest_power_ ? rest : signal;
    }

  private:
    static constexpr float kMaxAngle_rad = 1.0F;  // up to which sine and cosine below are near enough

    float line_ = 0.0F, quadrature_ = 0.0F;  // at the present angle, and a quarter of a turn later
    float rest_power_ = 0.0F;
};

}  // namespace antiskid::control
