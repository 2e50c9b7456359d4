#include "plant_sim/study/margins/loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace study::margins {

namespace {

/// An upper bound of |L(j w)| that decreases with w beyond all poles.
double bound(double gain, const std::vector<Complex>& zeros, const std::vector<Complex>& poles, double w) {
    double b = std::abs(gain);
    for (const Complex& z : zeros) b *= w + std::abs(z);
    for (const Complex& p : poles) {
        const double away = w - std::abs(p);
        if (away <= 0.0) return std::numeric_limits<double>::infinity();
        b /= away;
    }
    return b;
}

}  // namespace

DelayLoop::DelayLoop(double gain, std::vector<Complex> zeros, std::vector<Complex> poles, double delay_s)
    : gain_(gain), zeros_(std::move(zeros)), poles_(std::move(poles)), delay_s_(delay_s), end_radps_(1.0) {
    if (poles_.size() <= zeros_.size()) throw std::invalid_argument("a loop with a delay needs more poles than zeros");
    if (!(delay_s >= 0.0)) throw std::invalid_argument("a delay is not below zero");
    while (bound(gain_, zeros_, poles_, end_radps_) >= kNothing) end_radps_ *= 2.0;
}

Complex DelayLoop::value(Complex s) const {
    Complex l = gain_ * std::exp(-delay_s_ * s);
    for (const Complex& z : zeros_) l *= s - z;
    for (const Complex& p : poles_) l /= s - p;
    return l;
}

int DelayLoop::unstable_poles() const {
    return static_cast<int>(
        std::count_if(poles_.begin(), poles_.end(), [](const Complex& p) { return p.real() > 0.0 && std::abs(p) > kIndent_radps; }));
}

double DelayLoop::max_approach(Complex from, Complex to, const std::vector<Complex>& loci) const {
    const double reach = std::abs(to - from);
    const double numerator = std::abs(gain_) * std::exp(-delay_s_ * std::min(from.real(), to.real()));
    double numerator_slope = 0.0;  // of the product of the zeros' terms
    double product = 1.0;
    for (const Complex& z : zeros_) {
        const double far = std::abs(from - z) + reach;
        numerator_slope = numerator_slope * far + product;
        product *= far;
    }
    double denominator = 1.0;
    double turns = delay_s_;
    for (const Complex& p : poles_) {
        const double near = std::abs(from - p) - reach;
        if (near <= 0.0) return std::numeric_limits<double>::infinity();
        denominator *= near;
        turns += 1.0 / near;
    }
    return reach * numerator / denominator * (numerator_slope + product * turns) / std::abs(1.0 + loci[0]);
}

}  // namespace study::margins
