#include "rig_bridge/wear/population.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <memory>
#include <vector>

#include "rig_bridge/wear/health.hpp"
#include "rig_bridge/wear/health_limits.hpp"
#include "rig_bridge/wear/wearing_brake.hpp"

namespace wear {

namespace {

/// Limits from brakes that are drawn from the model with eq. (14), by either choice of component; the larger ones count.
HealthLimits limits_of_simulated(const Population& population) {
    constexpr std::uint64_t kBrakes = 500;
    const Model& model = population.models.front();
    const auto shared = std::make_shared<const Model>(model);
    const double begin_J = std::max(0.0, model.data.first_c_e_J - model.data.mean_step_J());
    HealthLimits out;
    for (const Choice choice : {Choice::nearest, Choice::mixture}) {
        std::vector<HealthLimits> greatest;
        greatest.reserve(kBrakes);
        for (std::uint64_t seed = 1; seed <= kBrakes; ++seed) {
            WearingBrake brake({shared, {}, model.data.last_c_e_J, {}}, {Variance::exact, choice}, {seed, 0, begin_J});
            HealthMonitor monitor(population);
            for (std::size_t i = 0; i < model.data.maneuvers; ++i) {
                const double friction = brake.next_friction();
                brake.take(model.data.mean_step_J());
                (void)monitor.after({brake.state().c_e_J, friction});
            }
            greatest.push_back(monitor.greatest());
        }
        const HealthLimits by_this = calibrated(greatest);
        for (const HealthTest test : kHealthTests) out.*test = std::max(out.*test, by_this.*test);
    }
    return out;
}

constexpr std::size_t kSteps = 1024;
constexpr ConditionalRule kMean{Variance::exact, Choice::mixture};

}  // namespace

Population brakes_like(const Model& model) {
    constexpr std::size_t kPlaces = 200;
    double variance = 0.0;
    for (std::size_t i = 0; i <= kPlaces; ++i) {
        const double c_e_J = model.data.first_c_e_J + (model.data.last_c_e_J - model.data.first_c_e_J) * static_cast<double>(i) / kPlaces;
        const Conditional c = friction_given_energy(model, c_e_J, {Variance::exact, Choice::mixture});
        variance += c.variance() / (kPlaces + 1);
    }
    const double deviation = std::sqrt(variance);
    const double half = std::sqrt(0.5 * variance);
    Population out;
    out.source = "one brake: " + model.data.source;
    out.provenance = {model.data.origin, 1};
    out.models = {model};
    out.members = {MeanCurve(model)};
    out.scatter = {0.5, half, half, 0.1 * deviation};
    out.spread = {0.1, 2.5 * deviation, 0.98};
    out.limits = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
    out.steady = steady_stage(out.members);
    return out;
}

Population population_of(const Model& model) {
    Population out = brakes_like(model);
    out.limits = limits_of_simulated(out);
    return out;
}

SteadyStage steady_stage(const std::vector<MeanCurve>& curves) {
    constexpr std::size_t kParts = 50;
    constexpr double kSteep = 6.0;
    SteadyStage out{0.0, std::numeric_limits<double>::infinity()};
    for (const MeanCurve& curve : curves) {
        const double part_J = (curve.last_J() - curve.first_J()) / kParts;
        std::array<double, kParts> slopes{};
        for (std::size_t i = 0; i < kParts; ++i) {
            const double at_J = curve.first_J() + part_J * static_cast<double>(i);
            slopes.at(i) = std::abs(curve(at_J + part_J) - curve(at_J));
        }
        std::array<double, kParts> sorted = slopes;
        std::nth_element(sorted.begin(), sorted.begin() + kParts / 2, sorted.end());
        const auto steep = [&](double slope) { return slope > kSteep * sorted[kParts / 2]; };
        const auto middle = slopes.begin() + kParts / 2;
        const auto first = std::find_if(std::make_reverse_iterator(middle), slopes.rend(), steep).base();
        const auto last = std::find_if(middle, slopes.end(), steep);
        out.from_J = std::max(out.from_J, curve.first_J() + part_J * static_cast<double>(first - slopes.begin()));
        out.to_J = std::min(out.to_J, curve.first_J() + part_J * static_cast<double>(last - slopes.begin()));
    }
    if (!(out.to_J > out.from_J) || curves.empty()) return {};
    return out;
}

MeanCurve::MeanCurve(const Model& model)
    : first_J_(model.data.first_c_e_J), last_J_(model.data.last_c_e_J), step_J_((last_J_ - first_J_) / static_cast<double>(kSteps)) {
    const auto mean = [&model](double c_e_J) { return friction_given_energy(model, c_e_J, kMean).mean(); };
    friction_.reserve(kSteps + 1);
    for (std::size_t i = 0; i <= kSteps; ++i) friction_.push_back(mean(first_J_ + step_J_ * static_cast<double>(i)));
    // Linear extrapolation: the weights stay those at the end.
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
