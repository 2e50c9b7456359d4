#include "rig_bridge/wear/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rig_bridge/wear/fit_search.hpp"

namespace wear {

namespace {

struct Scale {
    double c_mean_J = 0.0;
    double c_deviation_J = 1.0;
    double mu_mean = 0.0;
    double mu_deviation = 1.0;
};

Scale scale_of(const std::vector<Point>& points) {
    const auto n = static_cast<double>(points.size());
    Scale s;
    for (const Point& p : points) {
        s.c_mean_J += p.c_e_J / n;
        s.mu_mean += p.mean_friction / n;
    }
    double c = 0.0;
    double mu = 0.0;
    for (const Point& p : points) {
        c += (p.c_e_J - s.c_mean_J) * (p.c_e_J - s.c_mean_J) / n;
        mu += (p.mean_friction - s.mu_mean) * (p.mean_friction - s.mu_mean) / n;
    }
    s.c_deviation_J = std::sqrt(c);
    s.mu_deviation = std::sqrt(mu);
    return s;
}

StandardPoints standardised(const std::vector<Point>& points, const Scale& s) {
    std::vector<double> x(points.size());
    std::vector<double> y(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        x[i] = (points[i].c_e_J - s.c_mean_J) / s.c_deviation_J;
        y[i] = (points[i].mean_friction - s.mu_mean) / s.mu_deviation;
    }
    return {x, y};
}

Mixture in_units(const StandardMixture& m, const Scale& s) {
    std::vector<Component> out(m.components);
    for (std::size_t j = 0; j < m.components; ++j) {
        out[j] = {m.weight[j],
                  s.c_mean_J + s.c_deviation_J * m.mx[j],
                  s.mu_mean + s.mu_deviation * m.my[j],
                  s.c_deviation_J * s.c_deviation_J * m.xx[j],
                  s.c_deviation_J * s.mu_deviation * m.xy[j],
                  s.mu_deviation * s.mu_deviation * m.yy[j]};
    }
    std::sort(out.begin(), out.end(), [](const Component& a, const Component& b) { return a.mean_c_e_J < b.mean_c_e_J; });
    return Mixture(std::move(out));
}

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
    const Scale scale = scale_of(campaign.points);
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
        out.orders.push_back({m, log_likelihood, bic(log_likelihood, m, n), s.runs, s.not_converged, in_units(best.mixture, scale)});
        if (out.orders.back().bic < out.orders[out.chosen].bic) out.chosen = i;
    }
    return out;
}

}  // namespace wear
