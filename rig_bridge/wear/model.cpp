#include "rig_bridge/wear/model.hpp"

#include <algorithm>

namespace wear {

double Model::Data::mean_step_J() const {
    return (last_c_e_J - first_c_e_J) / static_cast<double>(maneuvers - 1);
}

bool Model::extrapolates(double c_e_J) const {
    return c_e_J < data.first_c_e_J - data.mean_step_J() || c_e_J > data.last_c_e_J + data.mean_step_J();
}

Model model_of(const Campaign& campaign, const Fit& fit, const FitSettings& settings) {
    const auto [min, greatest] = std::minmax_element(campaign.points.begin(), campaign.points.end(),
                                                     [](const Point& a, const Point& b) { return a.mean_friction < b.mean_friction; });
    Model model{{campaign.source, data_hash(campaign), campaign.points.size(), campaign.points.front().c_e_J, campaign.points.back().c_e_J,
                 min->mean_friction, greatest->mean_friction, campaign.origin},
                {settings.seed, settings.starts, settings.em.tolerance, settings.em.covariance_floor},
                {},
                fit.best().mixture};
    model.orders.reserve(fit.orders.size());
    for (const OrderFit& o : fit.orders) model.orders.push_back({o.components, o.log_likelihood, o.bic, o.score});
    return model;
}

Conditional friction_given_energy(const Model& model, double a_J, const ConditionalRule& rule) {
    return friction_given_energy(model.mixture, a_J, std::clamp(a_J, model.data.first_c_e_J, model.data.last_c_e_J), rule);
}

}  // namespace wear
