#include "plant_sim/wear/population.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "plant_sim/wear/health.hpp"
#include "plant_sim/wear/wearing_brake.hpp"

namespace wear {

namespace {

/// A quarter above what any of so many brakes that are the model itself reach in their lives, by either rule of eq. (14).
HealthLimits limits_of_simulated(const Population& population) {
    constexpr std::uint64_t kBrakes = 100;
    constexpr double kMargin = 1.25;
    const Model& model = population.models.front();
    const auto shared = std::make_shared<const Model>(model);
    HealthLimits out;
    for (std::uint64_t seed = 1; seed <= kBrakes; ++seed) {
        const ConditionalRule rule{Variance::exact, seed % 2 == 0 ? Choice::nearest : Choice::mixture};
        const double begin_J = std::max(0.0, model.data.first_c_e_J - model.data.mean_step_J());
        WearingBrake brake({shared, {}, model.data.last_c_e_J, {}}, rule, {seed, 0, begin_J});
        HealthMonitor monitor(population);
        for (std::size_t i = 0; i < model.data.maneuvers; ++i) {
            const double friction = brake.next_friction();
            brake.take(model.data.mean_step_J());
            (void)monitor.after({brake.state().c_e_J, friction});
        }
        out.gradual = std::max(out.gradual, monitor.greatest().gradual);
        out.sudden = std::max(out.sudden, monitor.greatest().sudden);
    }
    return {kMargin * out.gradual, kMargin * out.sudden};
}

}  // namespace

Population population_of(const Model& model) {
    constexpr std::size_t kPlaces = 200;
    double variance = 0.0;
    for (std::size_t i = 0; i <= kPlaces; ++i) {
        const double c_e_J = model.data.first_c_e_J + (model.data.last_c_e_J - model.data.first_c_e_J) *
                                                          static_cast<double>(i) / kPlaces;
        const Conditional c = friction_given_energy(model, c_e_J, {Variance::exact, Choice::mixture});
        variance += c.variance() / (kPlaces + 1);
    }
    const double deviation = std::sqrt(variance);
    const double half = std::sqrt(0.5 * variance);
    Population out;
    out.source = "one brake: " + model.data.source;
    out.models = {model};
    out.members = {MeanCurve(model)};
    out.scatter = {0.5, half, half, 0.1 * deviation};
    out.spread = {0.1, 2.5 * deviation, 0.98};
    out.limits = {1.0, 1.0};
    out.limits = limits_of_simulated(out);
    return out;
}

}  // namespace wear
