#include "rig_bridge/wear/fit_starts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wear {

namespace {

struct Centre {
    double x;
    double y;
};

double squared_distance(const Centre& a, const Centre& b) {
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

std::vector<Centre> spread_out(const std::vector<Centre>& points, std::size_t count, Generator& generator) {
    std::vector<Centre> centres;
    centres.reserve(count);
    std::vector<double> distance(points.size(), std::numeric_limits<double>::infinity());
    const auto pick = [&] { return std::min(points.size() - 1, static_cast<std::size_t>(uniform(generator) * static_cast<double>(points.size()))); };
    centres.push_back(points[pick()]);
    while (centres.size() < count) {
        double sum = 0.0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            distance[i] = std::min(distance[i], squared_distance(points[i], centres.back()));
            sum += distance[i];
        }
        double left = uniform(generator) * sum;
        std::size_t chosen = points.size() - 1;
        for (std::size_t i = 0; i < points.size(); ++i) {
            left -= distance[i];
            if (left < 0.0) {
                chosen = i;
                break;
            }
        }
        centres.push_back(points[chosen]);
    }
    return centres;
}

void assign(const std::vector<Centre>& points, const std::vector<Centre>& centres, std::vector<std::size_t>& label) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        std::size_t nearest = 0;
        double min = std::numeric_limits<double>::infinity();
        for (std::size_t j = 0; j < centres.size(); ++j) {
            const double d = squared_distance(points[i], centres[j]);
            if (d < min) {
                min = d;
                nearest = j;
            }
        }
        label[i] = nearest;
    }
}

void recentre(const std::vector<Centre>& points, const std::vector<std::size_t>& label, std::vector<Centre>& centres) {
    std::vector<Centre> sum(centres.size(), {0.0, 0.0});
    std::vector<double> count(centres.size(), 0.0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        sum[label[i]].x += points[i].x;
        sum[label[i]].y += points[i].y;
        count[label[i]] += 1.0;
    }
    for (std::size_t j = 0; j < centres.size(); ++j) {
        if (count[j] > 0.0) centres[j] = {sum[j].x / count[j], sum[j].y / count[j]};
    }
}

}  // namespace

StandardMixture random_start(const StandardPoints& points, std::size_t components, int sweeps, double covariance_floor, Generator& generator) {
    constexpr double kWidest = 4.0;
    const double stretch = std::pow(kWidest, 2.0 * uniform(generator) - 1.0);
    std::vector<Centre> stretched;
    stretched.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) stretched.push_back({stretch * points.x()[i], points.y()[i]});
    std::vector<Centre> centres = spread_out(stretched, components, generator);
    std::vector<std::size_t> label(points.size());
    assign(stretched, centres, label);
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        recentre(stretched, label, centres);
        assign(stretched, centres, label);
    }
    return mixture_of(points, label, components, covariance_floor);
}

StandardMixture split(const StandardMixture& mixture, std::size_t which, bool along) {
    StandardMixture m = mixture;
    const std::size_t other = m.components++;
    const double middle = 0.5 * (m.xx[which] + m.yy[which]);
    const double half = 0.5 * (m.xx[which] - m.yy[which]);
    const double radius = std::hypot(half, m.xy[which]);
    const double angle = 0.5 * std::atan2(m.xy[which], half);
    const double variance = along ? middle + radius : std::max(0.0, middle - radius);
    const double x = along ? std::cos(angle) : -std::sin(angle);
    const double y = along ? std::sin(angle) : std::cos(angle);
    // Halves at +-d along the axis with the variance reduced by d^2 have the mean and covariance of the whole.
    const double d = 0.5 * std::sqrt(variance);
    m.weight[which] *= 0.5;
    m.xx[which] -= d * d * x * x;
    m.xy[which] -= d * d * x * y;
    m.yy[which] -= d * d * y * y;
    m.weight[other] = m.weight[which];
    m.xx[other] = m.xx[which];
    m.xy[other] = m.xy[which];
    m.yy[other] = m.yy[which];
    m.mx[other] = m.mx[which] - d * x;
    m.my[other] = m.my[which] - d * y;
    m.mx[which] += d * x;
    m.my[which] += d * y;
    return m;
}

StandardMixture merged(const StandardMixture& mixture, std::size_t a, std::size_t b) {
    StandardMixture m = mixture;
    const double weight = m.weight[a] + m.weight[b];
    const double p = m.weight[a] / weight;
    const double q = m.weight[b] / weight;
    const double dx = m.mx[b] - m.mx[a];
    const double dy = m.my[b] - m.my[a];
    m.xx[a] = p * m.xx[a] + q * m.xx[b] + p * q * dx * dx;
    m.xy[a] = p * m.xy[a] + q * m.xy[b] + p * q * dx * dy;
    m.yy[a] = p * m.yy[a] + q * m.yy[b] + p * q * dy * dy;
    m.mx[a] += q * dx;
    m.my[a] += q * dy;
    m.weight[a] = weight;
    const std::size_t last = --m.components;
    m.weight[b] = m.weight[last];
    m.mx[b] = m.mx[last];
    m.my[b] = m.my[last];
    m.xx[b] = m.xx[last];
    m.xy[b] = m.xy[last];
    m.yy[b] = m.yy[last];
    return m;
}

}  // namespace wear
