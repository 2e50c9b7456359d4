#include "plant_sim/study/margins/limits.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace study::margins {

namespace {

double min_delay_s(double delay_s, double period_s) {
    constexpr double kRounding = 1e-6;  // of a period stored as float
    return period_s > 0.0 ? period_s * (1.0 + std::floor(delay_s / period_s + kRounding)) : delay_s;
}

}  // namespace

Limits limits(double wheel_pole_radps, double delay_s, double period_s) {
    if (wheel_pole_radps >= 0.0) return {};
    Limits l;
    l.gamma = std::exp(-wheel_pole_radps * min_delay_s(delay_s, period_s));
    l.phase_deg = 360.0 / std::numbers::pi * std::asin(1.0 / l.gamma);
    if (l.gamma > 1.0) l.gain_range_dB = 40.0 * std::log10((l.gamma + 1.0) / (l.gamma - 1.0));
    return l;
}

double creep_margin_dB(double wheel_pole_radps, double k_pole, double k_p_per_s) {
    const double returned = wheel_pole_radps > 0.0 ? 1.0 - k_pole - k_p_per_s / wheel_pole_radps : 0.0;
    return returned > 0.0 ? -20.0 * std::log10(returned) : std::numeric_limits<double>::infinity();
}

}  // namespace study::margins
