#include "rig_bridge/wear/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>

#include "rig_bridge/wear/fit_starts.hpp"
#include "rig_bridge/wear/on_threads.hpp"

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

/// The best run of one M so far; the first of equals.
struct Search {
    std::optional<EmRun> best;
    int runs = 0;
    int not_converged = 0;

    bool take(const EmRun& run) {
        ++runs;
        if (!run.converged) ++not_converged;
        if (best && run.log_likelihood <= best->log_likelihood) return false;
        best = run;
        return true;
    }
};

}  // namespace

Fit fit(const Campaign& campaign, const FitSettings& settings, const FitControl& control) {
    check(campaign, settings, control);
    const Scale scale = scale_of(campaign.points);
    const StandardPoints points = standardised(campaign.points, scale);
    const std::size_t min = settings.min_components;
    const std::size_t max = settings.max_components;
    const auto starts = static_cast<std::size_t>(settings.starts);

    std::vector<EmRun> random((max - min + 1) * starts);
    std::size_t splits = 0;
    for (std::size_t m = min; m < max; ++m) splits += 2 * m;
    std::mutex mutex;
    std::size_t done = 0;
    const auto on_all = [&](std::size_t count, const std::function<void(std::size_t)>& job) {
        run_jobs(control.threads, count, [&](std::size_t i) {
            if (control.stop.stop_requested()) throw Cancelled();
            job(i);
            const std::scoped_lock lock(mutex);
            ++done;
            if (control.progress) control.progress(done, random.size() + splits);
        });
    };
    on_all(random.size(), [&](std::size_t job) {
        const std::size_t m = max - job / starts;  // the long ones first, so that threads end together
        const std::size_t start = job % starts;
        constexpr int kSweeps = 10;
        Generator generator = generator_of(settings.seed, m * 1'000'000'000U + start);
        random[job] = em(points, random_start(points, m, start % 2 == 0 ? kSweeps : 0, settings.em.covariance_floor, generator), settings.em);
    });
    std::vector<Search> found(max + 1);
    for (std::size_t job = 0; job < random.size(); ++job) found[max - job / starts].take(random[job]);

    // What the best of M - 1 says, with one component split, is a start that random ones seldom find when M is large.
    for (std::size_t m = min + 1; m <= max; ++m) {
        const StandardMixture smaller = found[m - 1].best->mixture;
        std::vector<EmRun> runs(2 * (m - 1));
        on_all(runs.size(), [&](std::size_t job) { runs[job] = em(points, split(smaller, job / 2, job % 2 == 0), settings.em); });
        for (const EmRun& run : runs) found[m].take(run);
    }

    Fit out;
    out.orders.reserve(max - min + 1);
    const double per_point = std::log(scale.c_deviation_J * scale.mu_deviation);
    const auto n = campaign.points.size();
    for (std::size_t m = min; m <= max; ++m) {
        const Search& s = found[m];
        const double log_likelihood = s.best->log_likelihood - static_cast<double>(n) * per_point;
        out.orders.push_back({m, log_likelihood, bic(log_likelihood, m, n), s.runs, s.not_converged, in_units(s.best->mixture, scale)});
        if (out.orders.back().bic < out.orders[out.chosen].bic) out.chosen = m - min;
    }
    return out;
}

}  // namespace wear
