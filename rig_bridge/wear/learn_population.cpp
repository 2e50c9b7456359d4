#include "rig_bridge/wear/learn_population.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "rig_bridge/wear/brake_filter.hpp"
#include "rig_bridge/wear/forecast.hpp"
#include "rig_bridge/wear/health.hpp"
#include "rig_bridge/wear/health_limits.hpp"

namespace wear {

namespace {

/// Covariances of residuals `lag` maneuvers apart.
double covariance(const std::vector<double>& residuals, std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < residuals.size(); ++i) sum += residuals[i] * residuals[i - lag];
    return sum / static_cast<double>(residuals.size() - lag);
}

/// An autoregression seen through white noise: gamma_k = remembered^2 memory^k for k >= 1, and fresh^2 more for k = 0.
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
    // Two ratios, weighed by what they are known with.
    const double sum = gamma[1] + gamma[2];
    out.memory = sum > 0.0 ? std::clamp((gamma[2] + gamma[3]) / sum, 0.0, kMaxMemory) : 0.0;
    const double min_fresh = 0.01 * gamma[0];
    const double remembered = out.memory > 0.0 ? std::clamp(gamma[1] / out.memory, 0.0, gamma[0] - min_fresh) : 0.0;
    out.remembered = std::sqrt(remembered);
    out.fresh = std::sqrt(gamma[0] - remembered);
    return out;
}

/// The others' curves.
Population without(const Population& all, std::size_t k) {
    Population others;
    others.scatter = all.scatter;
    others.spread = all.spread;
    others.members = all.members;
    others.members.erase(others.members.begin() + static_cast<std::ptrdiff_t>(k));
    return others;
}

/// log p of every maneuver given those before it, each brake given the curves of the others.
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

/// The first energy at which the curve is below the limit.
double crossing_J(const MeanCurve& curve, double limit, double step_J) {
    double at_J = curve.first_J();
    while (at_J < curve.last_J() && curve(at_J) >= limit) at_J += step_J;
    return at_J;
}

/// Three limits that every brake crosses, between the highest friction that any of them ends with and the lowest that any of them has in the
/// middle of its life.
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

/// How often the 80 % interval of a forecast holds the energy at which a brake does cross, asked at 20, 40, 60 and 80 % of the way there,
/// each brake given the curves of the others.
double left_out_coverage(const std::vector<Campaign>& campaigns, const std::vector<double>& limits, const Population& all) {
    double longest_J = 0.0;
    for (const MeanCurve& c : all.members) longest_J = std::max(longest_J, c.last_J());
    // Energy counts here, not landings: fewer and larger ones than in any use cost nothing but resolution.
    const LandingMix mix{{"step", 1.0, longest_J / 200.0, 0.0}};
    ForecastSettings settings;
    settings.horizon = 500;
    settings.draws = 200;
    settings.fan_points = 0;
    double held = 0.0;
    double asked = 0.0;
    for (std::size_t k = 0; k < campaigns.size(); ++k) {
        const Population others = without(all, k);
        for (const double limit : limits) {
            settings.limit = limit;
            const double truth_J = crossing_J(all.members[k], limit, longest_J / 4000.0);
            BrakeFilter filter(others);
            int fifths = 1;
            for (const Point& p : campaigns[k].points) {
                filter.learn(p);
                if (p.c_e_J < 0.2 * fifths * truth_J) continue;
                const Forecast f = forecast(filter, p.c_e_J, mix, settings);
                held += truth_J >= f.crossing_J[0].value_or(1e300) && truth_J <= f.crossing_J[2].value_or(1e300) ? 1.0 : 0.0;
                asked += 1.0;
                if (++fifths > 4) break;
            }
        }
    }
    return held / asked;
}

/// The least spread of the energy scale at which the 80 % interval holds the truth in 80 % of cases, and one standard error of a share of so
/// many brakes more: those at hand may by chance be more alike than those to come.
double calibrated_spread(const std::vector<Campaign>& campaigns, const std::vector<double>& limits, Population population) {
    const double wanted = 0.8 + std::sqrt(0.8 * 0.2 / static_cast<double>(campaigns.size()));
    double low = 0.01;
    double high = 0.4;
    constexpr int kHalvings = 6;
    for (int i = 0; i < kHalvings; ++i) {
        population.spread.log_energy_scale = std::sqrt(low * high);
        (left_out_coverage(campaigns, limits, population) < wanted ? low : high) = population.spread.log_energy_scale;
    }
    return std::sqrt(low * high);
}

/// From `healthy` campaigns of other brakes; where there are none from the campaigns themselves, each given the curves of the others.
HealthLimits health_limits(const std::vector<Campaign>& campaigns, const std::vector<Campaign>& healthy, const Population& all) {
    const std::vector<Campaign>& watched = healthy.empty() ? campaigns : healthy;
    std::vector<HealthLimits> greatest;
    greatest.reserve(watched.size());
    for (std::size_t k = 0; k < watched.size(); ++k) {
        Population known = healthy.empty() ? without(all, k) : all;
        known.limits = {1.0, 1.0};
        HealthMonitor monitor(known);
        for (const Point& p : watched[k].points) (void)monitor.after(p);
        greatest.push_back(monitor.greatest());
    }
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
    for (const Campaign& c : campaigns) {
        out.models.push_back(model_of(c, fit(c, settings.fit, {settings.threads, {}, {}}), settings.fit));
        out.members.emplace_back(out.models.back());
        if (progress) progress(++done, steps);
    }
    out.scatter = scatter_of(campaigns, out.members);
    const double all_scatter = std::hypot(out.scatter.remembered, out.scatter.fresh);
    out.scatter.drift_per_root_MJ = 0.1 * all_scatter;
    out.spread = {0.1, 2.0 * all_scatter, settings.evidence_kept};
    Ascent maneuvers([&] { return left_out_maneuvers(campaigns, out); });
    for (const double factor : kFactors) {
        maneuvers.improve(out.scatter.drift_per_root_MJ, factor, all_scatter);
        maneuvers.improve(out.spread.offset, factor, 0.5);
        if (progress) progress(++done, steps);
    }
    out.spread.log_energy_scale = calibrated_spread(campaigns, settings.limit ? std::vector{*settings.limit} : limits_of(out.members), out);
    out.limits = health_limits(campaigns, settings.healthy, out);
    if (progress) progress(++done, steps);
    return out;
}

}  // namespace wear
