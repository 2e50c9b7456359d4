#include "rig_bridge/wear/fit.hpp"

#include <fmt/format.h>

#include <cmath>

#include "rig_bridge/wear/fit_search.hpp"
#include "rig_bridge/wear/standard_scale.hpp"

namespace wear {

namespace {

void check(const Campaign& campaign, const FitSettings& settings, const FitControl& control) {
    if (settings.min_components < 1 || settings.max_components > kMaxComponents || settings.min_components > settings.max_components)
        throw std::invalid_argument(
            fmt::format("components: {} to {} is no part of 1 to {}", settings.min_components, settings.max_components, kMaxComponents));
    if (settings.starts < 1) throw std::invalid_argument("starts: at least 1");
    if (!(settings.em.tolerance > 0.0) || !(settings.em.covariance_floor > 0.0) || settings.em.max_iterations < 1)
        throw std::invalid_argument("tolerance, covariance floor and iterations must be positive");
    if (control.threads < 1) throw std::invalid_argument("threads: at least 1");
    wear::check(campaign);
    const std::size_t points = campaign.points.size();
    if (points < 6 * settings.max_components)
        throw settings::Error(campaign.source, 0, "",
                              fmt::format("{} maneuvers are too few for {} components, which have {} "
                                          "parameters; at most {} can be learnt",
                                          points, settings.max_components, parameters_of(settings.max_components), points / 6));
}

}  // namespace

Fit fit(const Campaign& campaign, const FitSettings& settings, const FitControl& control) {
    check(campaign, settings, control);
    const StandardScale scale = scale_of(campaign.points);
    const std::vector<OrderSearch> found = search_orders(standardised(campaign.points, scale), settings, control);

    Fit out;
    out.orders.reserve(found.size());
    const double per_point = std::log(scale.c_deviation_J * scale.mu_deviation);
    const auto n = campaign.points.size();
    for (std::size_t i = 0; i < found.size(); ++i) {
        const OrderSearch& s = found[i];
        const EmRun& best = s.best.front().run;
        const std::size_t m = best.mixture.components;
        const double log_likelihood = best.log_likelihood - static_cast<double>(n) * per_point;
        out.orders.push_back({m, log_likelihood, bic(log_likelihood, m, n), s.runs, s.not_converged, in_units(best.mixture, scale), {}});
        if (out.orders.back().bic < out.orders[out.chosen].bic) out.chosen = i;
    }
    return out;
}

}  // namespace wear
