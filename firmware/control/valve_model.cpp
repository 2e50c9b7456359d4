#include "firmware/control/valve_model.hpp"

#include "firmware/control/arithmetic.hpp"

namespace antiskid::control {

namespace {

/// y at x on the polyline (xs, ys), held beyond its ends.
float interpolate(const std::array<float, ValveConfig::kMaxPoints>& xs, const std::array<float, ValveConfig::kMaxPoints>& ys, std::size_t points,
                  float x) {
    if (!(x > xs[0])) return ys[0];
    for (std::size_t i = 1; i < points; ++i) {
        if (x <= xs[i]) return ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1]);
    }
    return ys[points - 1];
}

/// An offset at rest over the innovation that it leaves: the correction of the state takes the rest.
float over_innovation(float l_over_w, float damping) {
    return 1.0F + l_over_w * (2.0F * damping + 0.5F * l_over_w);
}

}  // namespace

float valve_current_mA(const ValveConfig& valve, float pressure_Pa) {
    if (!(pressure_Pa > valve.pressure_Pa[0])) return valve.safe_current_mA;
    return interpolate(valve.pressure_Pa, valve.current_mA, valve.points, pressure_Pa);
}

float valve_pressure_Pa(const ValveConfig& valve, float current_mA) {
    return interpolate(valve.current_mA, valve.pressure_Pa, valve.points, current_mA);
}

ValveModel::ValveModel(const ValveConfig& valve, float period_s, const EstimatorConfig& estimator)
    : correct_offset_(estimator.valve_offset_radps * period_s),
      offset_share_(estimator.valve_offset_share),
      max_offset_Pa_(estimator.valve_offset_share * valve.full_pressure_Pa),
      max_innovation_Pa_(max_offset_Pa_ / over_innovation(estimator.pressure_bandwidth_radps / valve.natural_frequency_radps, valve.damping)) {
    const float delay = valve.delay_s / period_s;
    while (whole_ < kMaxDelay && static_cast<float>(whole_ + 1) <= delay + 1e-3F) ++whole_;
    part_ = limited(delay - static_cast<float>(whole_), 0.0F, 1.0F);
    if (part_ < 1e-3F) part_ = 0.0F;
    delay_s_ = static_cast<float>(whole_) * period_s;

    // exp(A h) by its Taylor series over h / 32 and five squarings: plain arithmetic, the same bits on every
    // machine.
    const float w = valve.natural_frequency_radps;
    const float h = period_s / 32.0F;
    const float m21 = -w * w * h, m22 = -2.0F * valve.damping * w * h, m12 = h;
    float s11 = 0.0F, s12 = 0.0F, s21 = 0.0F, s22 = 0.0F;  // exp(A h) - I, to keep digits
    float t11 = 1.0F, t12 = 0.0F, t21 = 0.0F, t22 = 1.0F;
    for (int n = 1; n <= 6; ++n) {
        const float f = 1.0F / static_cast<float>(n);
        const float n11 = t12 * m21 * f, n12 = (t11 * m12 + t12 * m22) * f;
        const float n21 = t22 * m21 * f, n22 = (t21 * m12 + t22 * m22) * f;
        t11 = n11, t12 = n12, t21 = n21, t22 = n22;
        s11 += t11, s12 += t12, s21 += t21, s22 += t22;
    }
    for (int n = 0; n < 5; ++n) {
        // (I + S)^2 - I = 2 S + S S
        const float q11 = 2.0F * s11 + s11 * s11 + s12 * s21, q12 = 2.0F * s12 + s11 * s12 + s12 * s22;
        const float q21 = 2.0F * s21 + s21 * s11 + s22 * s21, q22 = 2.0F * s22 + s21 * s12 + s22 * s22;
        s11 = q11, s12 = q12, s21 = q21, s22 = q22;
    }
    a12_ = s12, a22_ = 1.0F + s22;
    b1_ = -s11, b2_ = -s21;

    const float l = estimator.pressure_bandwidth_radps * period_s;
    correct_pressure_ = l / (1.0F + l);
    correct_rate_ = correct_pressure_ * estimator.pressure_bandwidth_radps * 0.5F;
}

void ValveModel::update(float command_Pa, float measured_Pa, bool fresh) {
    newest_ = (newest_ + 1) % kKept;
    inputs_[newest_] = (1.0F - part_) * command_Pa + part_ * newest_command_Pa_;
    newest_command_Pa_ = command_Pa;
    const float acting = input(0);
    propagate(uncorrected_, acting);
    propagate(state_, acting + offset_Pa_);
    if (!fresh) return;
    const float innovation = measured_Pa - state_.pressure_Pa;
    state_.pressure_Pa += correct_pressure_ * innovation;
    state_.rate_Paps += correct_rate_ * innovation;
    // The innovation is limited to what an offset can cause: a wrong current for 50 ms must not be learnt as an offset.
    const float taught = limited(innovation, -max_innovation_Pa_, max_innovation_Pa_);
    offset_Pa_ = limited(offset_Pa_ + correct_offset_ * taught, -max_offset_Pa_, max_offset_Pa_);
}

/// Compensates at most a share of the request, so that zero stays zero.
float ValveModel::compensated_Pa(float pressure_Pa) const {
    const float max = offset_share_ * pressure_Pa;
    return pressure_Pa - limited(offset_Pa_, -max, max);
}

}  // namespace antiskid::control
