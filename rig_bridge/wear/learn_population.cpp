#include "rig_bridge/wear/learn_population.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "rig_bridge/wear/brake_filter.hpp"
#include "rig_bridge/wear/forecast.hpp"
#include "rig_bridge/wear/health.hpp"
#include "rig_bridge/wear/health_limits.hpp"
#include "rig_bridge/wear/on_threads.hpp"
#include "rig_bridge/wear/past_lives.hpp"

namespace wear {

namespace {

/// Covariances of residuals `lag` maneuvers apart.
double covariance(const std::vector<double>& residuals, std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < residuals.size(); ++i) sum += residuals[i] * residuals[i - lag];
    return sum / static_cast<double>(residuals.size() - lag);
}

/// Autoregression with white noise: gamma_k = remembered^2 memory^k for k >= 1, and additionally fresh^2 for k = 0.
Scatter scatter_of(const std::vector<Campaign>& campaigns, const std::vector<MeanCurve>& curves) {
    constexpr std::size_t kLags = 4;
    std::array<double, kLags> gamma{};
    for (std::size_t k = 0; k < campaigns.size(); ++k) {
        std::vector<double> residuals;
        residuals.reserve(campaigns[k].points.size());
        for (const Point& p : campaigns[k].points) residuals.push_back(p.mean_friction - curves[k](p.c_e_J));
        for (std::size_t lag = 0; lag < kLags; ++lag) gamma.at(lag) += covariance(residuals, lag) / static_cast<double>(campaigns.size());
    }
    Scatter out;
    constexpr double kMaxMemory = 0.95;
    // Mean of two ratios, weighted by their precision.
    const double sum = gamma[1] + gamma[2];
    out.memory = sum > 0.0 ? std::clamp((gamma[2] + gamma[3]) / sum, 0.0, kMaxMemory) : 0.0;
    const double min_fresh = 0.01 * gamma[0];
    const double remembered = out.memory > 0.0 ? std::clamp(gamma[1] / out.memory, 0.0, gamma[0] - min_fresh) : 0.0;
    out.remembered = std::sqrt(remembered);
    out.fresh = std::sqrt(gamma[0] - remembered);
    return out;
}

/// The population without brake `k`.
Population without(const Population& all, std::size_t k) {
    Population others;
    others.scatter = all.scatter;
    others.spread = all.spread;
    others.steady = all.steady;
    others.members = all.members;
    others.members.erase(others.members.begin() + static_cast<std::ptrdiff_t>(k));
    return others;
}

/// log p of each maneuver given the earlier ones, for each brake with the curves of the others.
double left_out_maneuvers(const std::vector<Campaign>& campaigns, const Population& all) {
    double sum = 0.0;
    for (std::size_t k = 0; k < campaigns.size(); ++k) {
        const Population others = without(all, k);
        BrakeFilter filter(others);
        for (const Point& p : campaigns[k].points) {
            sum += filter.log_density(p);
            filter.learn(p);
        }
    }
    return sum;
}

/// Three limits that every brake crosses, between the highest final friction of any brake and the lowest friction of any brake in the middle of its
/// life.
std::vector<double> limits_of(const std::vector<MeanCurve>& curves) {
    double end = 0.0;
    double middle = 1.0;
    for (const MeanCurve& c : curves) {
        end = std::max(end, c(c.last_J()));
        middle = std::min(middle, c(0.5 * c.last_J()));
    }
    const double room = std::max(0.0, middle - end);
    return {end + 0.2 * room, end + 0.5 * room, end + 0.8 * room};
}

/// Each brake given the curves of the others: what the filter's forecasts of the end lose, at each tenth of the way to it. A life ends where the
/// brake's own curve is below the limit.
double left_out_ends(const std::vector<Campaign>& campaigns, const std::vector<double>& limits, const Population& all, unsigned threads) {
    double longest_J = 0.0;
    for (const MeanCurve& c : all.members) longest_J = std::max(longest_J, c.last_J());
    // Only energy matters here, not landings: fewer and larger landings than in use reduce only the resolution.
    const LandingMix mix{{"step", 1.0, longest_J / 200.0, 0.0}};
    ForecastSettings settings;
    settings.horizon = 400;
    settings.draws = 100;
    settings.fan_points = 0;
    std::vector<double> loss(campaigns.size());
    run_jobs(threads, campaigns.size(), [&](std::size_t k) {
        const Population others = without(all, k);
        for (const double limit : limits) {
            ForecastSettings ask = settings;
            ask.limit = limit;
            const double truth_J = crossing_J(all.members[k], limit, longest_J / 4000.0, all.members[k].last_J());
            BrakeFilter filter(others);
            int tenths = 1;
            for (const Point& p : campaigns[k].points) {
                filter.learn(p);
                if (p.c_e_J < 0.1 * tenths * truth_J) continue;
                Forecast f = forecast(filter, p.c_e_J, mix, ask);
                for (double& end_J : f.energies_J) end_J = std::min(end_J, p.c_e_J + 2.0 * longest_J);
                loss[k] += crps(f.energies_J, truth_J) / truth_J;
                if (++tenths > 9) break;
            }
        }
    });
    return std::accumulate(loss.begin(), loss.end(), 0.0);
}

/// Spread of the energy scale and fading of evidence by what forecasts lose.
void choose_spread(const std::vector<Campaign>& campaigns, const std::vector<double>& limits, Population& population, unsigned threads) {
    Spread best = population.spread;
    double least = std::numeric_limits<double>::infinity();
    for (const double log_energy_scale : {0.02, 0.06, 0.15}) {
        for (const double kept : {0.95, 0.98, 0.995}) {
            population.spread.log_energy_scale = log_energy_scale;
            population.spread.evidence_kept = kept;
            const double loss = left_out_ends(campaigns, limits, population, threads);
            if (loss >= least) continue;
            least = loss;
            best = population.spread;
        }
    }
    population.spread = best;
}

/// Limits from `healthy` campaigns of other brakes; without any, from the campaigns themselves, each with the curves of the others.
HealthLimits health_limits(const std::vector<Campaign>& campaigns, const std::vector<Campaign>& healthy, const Population& all, unsigned threads) {
    const std::vector<Campaign>& watched = healthy.empty() ? campaigns : healthy;
    std::vector<HealthLimits> greatest(watched.size());
    run_jobs(threads, watched.size(), [&](std::size_t k) {
        Population known = healthy.empty() ? without(all, k) : all;
        known.limits = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
        HealthMonitor monitor(known);
        for (const Point& p : watched[k].points) (void)monitor.after(p);
        greatest[k] = monitor.greatest();
    });
    return calibrated(greatest);
}

/// Raises or lowers one parameter at a time by ever smaller factors while that raises an objective.
class Ascent {
  public:
    explicit Ascent(std::function<double()> objective) : objective_(std::move(objective)), best_(objective_()) {}

    void improve(double& parameter, double factor, double max) {
        for (const double by : {factor, 1.0 / factor}) {
            bool gained = false;
            while (attempt(parameter, std::min(max, parameter * by))) gained = true;
            if (gained) return;
        }
    }

  private:
    bool attempt(double& parameter, double value) {
        constexpr double kMinGain = 0.1;
        const double before = parameter;
        parameter = value;
        const double now = objective_();
        if (now > best_ + kMinGain) {
            best_ = now;
            return true;
        }
        parameter = before;
        return false;
    }

    std::function<double()> objective_;
    double best_;
};

}  // namespace

Population learn_population(const std::vector<Campaign>& campaigns, const LearnSettings& settings,
                            const std::function<void(std::size_t, std::size_t)>& progress) {
    if (campaigns.size() < 3)
        throw std::invalid_argument(
            fmt::format("{} campaigns: how brakes differ can be learnt from three at least, better twenty", campaigns.size()));
    constexpr std::array kFactors{2.0, 1.3};
    const std::size_t steps = campaigns.size() + kFactors.size() + 1;
    std::size_t done = 0;
    Population out;
    out.source = fmt::format("{} campaigns", campaigns.size());
    std::vector<std::string> origins;
    for (const Campaign& c : campaigns) {
        origins.push_back(c.origin);
        out.models.push_back(model_of(c, fit(c, settings.fit, {settings.threads, {}, {}}), settings.fit));
        out.members.emplace_back(out.models.back());
        if (progress) progress(++done, steps);
    }
    out.provenance = {common_origin(origins), campaigns.size()};
    out.scatter = scatter_of(campaigns, out.members);
    const double all_scatter = std::hypot(out.scatter.remembered, out.scatter.fresh);
    out.scatter.drift_per_root_MJ = 0.1 * all_scatter;
    out.spread = {0.1, 2.0 * all_scatter, 0.98};
    Ascent maneuvers([&] { return left_out_maneuvers(campaigns, out); });
    for (const double factor : kFactors) {
        maneuvers.improve(out.scatter.drift_per_root_MJ, factor, all_scatter);
        maneuvers.improve(out.spread.offset, factor, 0.5);
        if (progress) progress(++done, steps);
    }
    const std::vector<double> limits = settings.limit ? std::vector{*settings.limit} : limits_of(out.members);
    choose_spread(campaigns, limits, out, settings.threads);
    out.curves = learn_life_curves(campaigns, settings.limit.value_or(0.0), settings.threads);
    out.steady = steady_stage(out.members);
    out.limits = health_limits(campaigns, settings.healthy, out, settings.threads);
    if (progress) progress(++done, steps);
    return out;
}

}  // namespace wear
