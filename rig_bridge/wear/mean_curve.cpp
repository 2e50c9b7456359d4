#include "rig_bridge/wear/mean_curve.hpp"

#include <cstddef>

namespace wear {

namespace {

constexpr std::size_t kSteps = 1024;
constexpr ConditionalRule kMean{Variance::exact, Choice::mixture};

}  // namespace

MeanCurve::MeanCurve(const Model& model)
    : first_J_(model.data.first_c_e_J), last_J_(model.data.last_c_e_J), step_J_((last_J_ - first_J_) / static_cast<double>(kSteps)) {
    const auto mean = [&model](double c_e_J) { return friction_given_energy(model, c_e_J, kMean).mean(); };
    friction_.reserve(kSteps + 1);
    for (std::size_t i = 0; i <= kSteps; ++i) friction_.push_back(mean(first_J_ + step_J_ * static_cast<double>(i)));
    // Straight lines there: the weights stay those at the end.
    slope_before_perJ_ = (mean(first_J_) - mean(first_J_ - step_J_)) / step_J_;
    slope_after_perJ_ = (mean(last_J_ + step_J_) - mean(last_J_)) / step_J_;
}

double MeanCurve::operator()(double c_e_J) const {
    if (c_e_J <= first_J_) return friction_.front() + slope_before_perJ_ * (c_e_J - first_J_);
    if (c_e_J >= last_J_) return friction_.back() + slope_after_perJ_ * (c_e_J - last_J_);
    const double at = (c_e_J - first_J_) / step_J_;
    const auto i = static_cast<std::size_t>(at);
    if (i >= kSteps) return friction_.back();
    return friction_[i] + (friction_[i + 1] - friction_[i]) * (at - static_cast<double>(i));
}

}  // namespace wear
