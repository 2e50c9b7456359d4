#include "rig_bridge/wear/standard_scale.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wear {

StandardScale scale_of(const std::vector<Point>& points) {
    const auto n = static_cast<double>(points.size());
    StandardScale s;
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

StandardPoints standardised(const std::vector<Point>& points, const StandardScale& s) {
    std::vector<double> x(points.size());
    std::vector<double> y(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        x[i] = (points[i].c_e_J - s.c_mean_J) / s.c_deviation_J;
        y[i] = (points[i].mean_friction - s.mu_mean) / s.mu_deviation;
    }
    return {x, y};
}

StandardMixture standardised(const Mixture& mixture, const StandardScale& s) {
    StandardMixture out;
    for (const Component& c : mixture.components()) {
        const std::size_t j = out.components++;
        out.weight.at(j) = c.weight;
        out.mx.at(j) = (c.mean_c_e_J - s.c_mean_J) / s.c_deviation_J;
        out.my.at(j) = (c.mean_friction - s.mu_mean) / s.mu_deviation;
        out.xx.at(j) = c.variance_c_e_J2 / (s.c_deviation_J * s.c_deviation_J);
        out.xy.at(j) = c.covariance_J / (s.c_deviation_J * s.mu_deviation);
        out.yy.at(j) = c.variance_friction / (s.mu_deviation * s.mu_deviation);
    }
    return out;
}

Mixture in_units(const StandardMixture& m, const StandardScale& s) {
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

}  // namespace wear
