#include "rig_bridge/wear/em.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "rig_bridge/wear/em_pass.hpp"

namespace wear {

namespace {

/// Raises eigenvalues below `floor` to it; keeps the eigenvectors.
void bound_below(double& xx, double& xy, double& yy, double floor) {
    const double middle = 0.5 * (xx + yy);
    const double half = 0.5 * (xx - yy);
    const double radius = std::hypot(half, xy);
    const double min = middle - radius;
    if (min >= floor) return;
    const double greatest = std::max(middle + radius, floor);
    // The matrix is middle I + radius [cos, sin; sin, -cos].
    const double cosine = radius > 0.0 ? half / radius : 1.0;
    const double sine = radius > 0.0 ? xy / radius : 0.0;
    const double new_middle = 0.5 * (greatest + floor);
    const double new_radius = 0.5 * (greatest - floor);
    xx = new_middle + new_radius * cosine;
    yy = new_middle - new_radius * cosine;
    xy = new_radius * sine;
}

void whiten(const StandardMixture& m, std::array<Whitened, kMaxSearched>& out) {
    for (std::size_t j = 0; j < m.components; ++j) {
        const double l11 = std::sqrt(m.xx[j]);
        const double l21 = m.xy[j] / l11;
        const double l22 = std::sqrt(m.yy[j] - l21 * l21);
        out[j] = {m.mx[j], m.my[j], 1.0 / l11, -l21 / (l11 * l22), 1.0 / l22, std::log(m.weight[j]) - std::log(2.0 * std::numbers::pi * l11 * l22)};
    }
}

// A component with less weight than this is not changed: any parameters maximise its likelihood, which is zero.
constexpr double kNothing = 1e-12;

void maximise(const Pass& sums, double points, double floor, StandardMixture& m) {
    double all = 0.0;
    for (std::size_t j = 0; j < m.components; ++j) {
        const Moments& s = sums.moments[j];
        m.weight[j] = std::max(s.n, kNothing) / points;
        all += m.weight[j];
        if (s.n <= kNothing) continue;
        const double x = s.x / s.n;
        const double y = s.y / s.n;
        m.mx[j] += x;
        m.my[j] += y;
        m.xx[j] = s.xx / s.n - x * x;
        m.xy[j] = s.xy / s.n - x * y;
        m.yy[j] = s.yy / s.n - y * y;
        bound_below(m.xx[j], m.xy[j], m.yy[j], floor);
    }
    for (std::size_t j = 0; j < m.components; ++j) m.weight[j] /= all;
}

/// Limit of three successive EM steps by extrapolation; none if the steps do not shrink.
std::optional<StandardMixture> extrapolated(const StandardMixture& first, const StandardMixture& second, const StandardMixture& third, double floor) {
    StandardMixture out = third;
    const auto each_parameter = [&](const auto& use) {
        for (const auto list : {&StandardMixture::weight, &StandardMixture::mx, &StandardMixture::my, &StandardMixture::xx, &StandardMixture::xy,
                                &StandardMixture::yy}) {
            for (std::size_t j = 0; j < out.components; ++j) {
                const double step = (second.*list)[j] - (first.*list)[j];
                use((out.*list)[j], (first.*list)[j], step, (third.*list)[j] - (second.*list)[j] - step);
            }
        }
    };
    double steps = 0.0;
    double changes = 0.0;
    each_parameter([&](double&, double, double step, double change) {
        steps += step * step;
        changes += change * change;
    });
    if (!(steps > changes)) return std::nullopt;
    const double length = std::sqrt(steps / changes);
    if (!std::isfinite(length)) return std::nullopt;
    each_parameter([&](double& value, double from, double step, double change) { value = from + length * (2.0 * step + length * change); });
    constexpr double kMinWeight = 1e-6;  // the extrapolated one may be below 0
    double all = 0.0;
    for (std::size_t j = 0; j < out.components; ++j) {
        out.weight[j] = std::max(out.weight[j], kMinWeight);
        all += out.weight[j];
        bound_below(out.xx[j], out.xy[j], out.yy[j], floor);
    }
    for (std::size_t j = 0; j < out.components; ++j) out.weight[j] /= all;
    return out;
}

}  // namespace

StandardPoints::StandardPoints(std::span<const double> x, std::span<const double> y) : size_(x.size()) {
    const std::size_t padded = (size_ + kBlock - 1) / kBlock * kBlock;
    x_.assign(padded, 0.0);
    y_.assign(padded, 0.0);
    there_.assign(padded, 0.0);
    std::copy(x.begin(), x.end(), x_.begin());
    std::copy(y.begin(), y.end(), y_.begin());
    std::fill_n(there_.begin(), size_, 1.0);
}

EmRun em(const StandardPoints& points, const StandardMixture& start, const EmSettings& settings, const std::function<void(double)>& watch) {
    EmRun run;
    run.mixture = start;
    for (std::size_t j = 0; j < start.components; ++j)
        bound_below(run.mixture.xx[j], run.mixture.xy[j], run.mixture.yy[j], settings.covariance_floor);
    const auto n = static_cast<double>(points.size());
    std::array<Whitened, kMaxSearched> whitened{};
    Pass sums;
    const auto left = [&] { return run.iterations < settings.max_iterations; };
    const auto step_from = [&](StandardMixture mixture, double at_least) {
        ++run.iterations;
        whiten(mixture, whitened);
        pass(points, whitened.data(), mixture.components, sums);
        if (sums.log_likelihood < at_least) return false;
        maximise(sums, n, settings.covariance_floor, mixture);
        run.mixture = mixture;
        run.log_likelihood = sums.log_likelihood;
        if (watch) watch(run.log_likelihood);
        return true;
    };
    constexpr double kAny = -std::numeric_limits<double>::infinity();
    double before = kAny;
    while (left()) {
        const StandardMixture first = run.mixture;
        step_from(first, kAny);
        if (run.log_likelihood - before < settings.tolerance * n) {
            run.converged = true;
            break;
        }
        before = run.log_likelihood;
        if (!left()) break;
        const StandardMixture second = run.mixture;
        step_from(second, kAny);
        const auto far = left() ? extrapolated(first, second, run.mixture, settings.covariance_floor) : std::nullopt;
        if (far && !step_from(*far, run.log_likelihood)) ++run.refused;
    }
    return run;
}

StandardMixture mixture_of(const StandardPoints& points, std::span<const std::size_t> label, std::size_t components, double covariance_floor) {
    constexpr double kWider = 0.01;
    StandardMixture m;
    m.components = components;
    Pass sums;
    for (std::size_t i = 0; i < points.size(); ++i) {
        Moments& s = sums.moments[label[i]];
        const double x = points.x()[i];
        const double y = points.y()[i];
        s.n += 1.0;
        s.x += x;
        s.y += y;
        s.xx += x * x;
        s.xy += x * y;
        s.yy += y * y;
    }
    for (std::size_t j = 0; j < components; ++j) m.xx[j] = m.yy[j] = 1.0;
    maximise(sums, static_cast<double>(points.size()), covariance_floor, m);
    for (std::size_t j = 0; j < components; ++j) {
        m.xx[j] += kWider;
        m.yy[j] += kWider;
    }
    return m;
}

double log_likelihood(const StandardPoints& points, const StandardMixture& mixture) {
    std::array<Whitened, kMaxSearched> whitened{};
    Pass sums;
    whiten(mixture, whitened);
    pass(points, whitened.data(), mixture.components, sums);
    return sums.log_likelihood;
}

}  // namespace wear
