#include "rig_bridge/wear/forecast.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace wear {

namespace {

constexpr std::array kShares{0.1, 0.5, 0.9};

/// The value that `share` of the sorted values do not exceed.
template <typename T>
T quantile(const std::vector<T>& sorted, double share) {
    const auto at = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
    return sorted[std::clamp<std::size_t>(at, 1, sorted.size()) - 1];
}

void check(const LandingMix& mix, const ForecastSettings& settings) {
    double shares = 0.0;
    for (const LandingKind& kind : mix) {
        if (!(kind.share > 0.0 && kind.energy_J > 0.0 && kind.deviation_J >= 0.0 && std::isfinite(kind.energy_J) && std::isfinite(kind.deviation_J)))
            throw std::invalid_argument("landing '" + kind.name + "': share and energy must be positive");
        shares += kind.share;
    }
    if (std::abs(shares - 1.0) > 1e-6) throw std::invalid_argument("the shares of the landings must add up to 1");
    if (!(settings.limit > 0.0) || settings.horizon < 1 || settings.draws < 100)
        throw std::invalid_argument("forecast: limit, horizon, draws (at least 100) or fan out of range");
}

double landing_energy_J(const LandingMix& mix, Generator& generator) {
    double left = uniform(generator);
    const LandingKind* chosen = &mix.back();
    for (const LandingKind& kind : mix) {
        if (left < kind.share) {
            chosen = &kind;
            break;
        }
        left -= kind.share;
    }
    return std::max(0.0, chosen->energy_J + chosen->deviation_J * normal(generator));
}

/// One possible future.
class Future {
  public:
    Future(const BrakeFilter& filter, double c_e_J, const LandingMix& mix, std::uint64_t seed, int number)
        : filter_(filter), mix_(mix), generator_(generator_of(seed, static_cast<std::uint64_t>(number))), c_e_J_(c_e_J) {
        double left = uniform(generator_);
        hypothesis_ = filter.hypotheses().back();
        for (const BrakeFilter::Hypothesis& h : filter.hypotheses()) {
            if (left < h.weight) {
                hypothesis_ = h;
                break;
            }
            left -= h.weight;
        }
        hypothesis_.offset += std::sqrt(std::max(0.0, filter.offset_variance())) * normal(generator_);
    }

    void land() {
        const double energy_J = landing_energy_J(mix_, generator_);
        c_e_J_ += energy_J;
        hypothesis_.offset += filter_.population().scatter.drift_per_root_MJ * std::sqrt(energy_J * 1e-6) * normal(generator_);
    }
    [[nodiscard]] double friction() const { return filter_.mean_friction(hypothesis_, c_e_J_); }
    [[nodiscard]] double c_e_J() const { return c_e_J_; }
    [[nodiscard]] bool extrapolates() const { return c_e_J_ / hypothesis_.energy_scale > filter_.population().members[hypothesis_.member].last_J(); }

  private:
    const BrakeFilter& filter_;
    const LandingMix& mix_;
    Generator generator_;
    double c_e_J_;
    BrakeFilter::Hypothesis hypothesis_;
};

std::vector<FanPoint> fan(const BrakeFilter& filter, double c_e_J, const LandingMix& mix, const ForecastSettings& settings, int last) {
    constexpr int kFutures = 500;
    const int points = std::min(settings.fan_points, last + 1);
    std::vector<FanPoint> out(static_cast<std::size_t>(points));
    std::vector<std::vector<double>> frictions(out.size());
    for (int n = 0; n < std::min(kFutures, settings.draws); ++n) {
        Future future(filter, c_e_J, mix, settings.seed, n);
        int landed = 0;
        for (int i = 0; i < points; ++i) {
            const int until = static_cast<int>(std::int64_t{last} * i / std::max(1, points - 1));
            for (; landed < until; ++landed) future.land();
            const auto at = static_cast<std::size_t>(i);
            out[at].landings = until;
            out[at].c_e_J += future.c_e_J();
            frictions[at].push_back(future.friction());
        }
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
        std::sort(frictions[i].begin(), frictions[i].end());
        out[i].c_e_J /= static_cast<double>(frictions[i].size());
        for (std::size_t q = 0; q < kShares.size(); ++q) out[i].friction[q] = quantile(frictions[i], kShares[q]);
    }
    return out;
}

}  // namespace

LandingMix mix_of(const Campaign& campaign, std::size_t count) {
    std::vector<double> energies_J;
    if (campaign.landings.empty())
        for (std::size_t i = 1; i < campaign.points.size(); ++i) energies_J.push_back(brake_energy_J(campaign, i));
    for (const LandingEnergy& landing : campaign.landings)
        if (landing.c_e_J > campaign.points.front().c_e_J) energies_J.push_back(landing.energy_J);
    double sum = 0.0;
    double squares = 0.0;
    const std::size_t n = energies_J.size();
    for (std::size_t i = n - std::min(n, count); i < n; ++i) {
        sum += energies_J[i];
        squares += energies_J[i] * energies_J[i];
    }
    const auto used = static_cast<double>(std::min(n, count));
    const double mean = sum / used;
    return {{"as recorded", 1.0, mean, std::sqrt(std::max(0.0, squares / used - mean * mean))}};
}

double landings_until(double end_J, double c_e_J, const LandingMix& mix, int horizon, Generator& generator) {
    int n = 0;
    for (; c_e_J < end_J; ++n) {
        if (n == horizon) return std::numeric_limits<double>::infinity();
        c_e_J += landing_energy_J(mix, generator);
    }
    return n;
}

void take_quantiles(Forecast& f) {
    for (std::size_t q = 0; q < kShares.size(); ++q) {
        const double left = quantile(f.landings, kShares[q]);
        const bool ever = std::isfinite(left);
        f.landings_left[q] = ever ? std::optional(static_cast<int>(std::lround(left))) : std::nullopt;
        f.crossing_J[q] = ever ? std::optional(quantile(f.energies_J, kShares[q])) : std::nullopt;
    }
}

double crps(const std::vector<double>& rising, double x) {
    const auto n = static_cast<double>(rising.size());
    double off = 0.0;
    double apart = 0.0;
    for (std::size_t i = 0; i < rising.size(); ++i) {
        off += std::abs(rising[i] - x) / n;
        apart += (2.0 * static_cast<double>(i) + 1.0 - n) * rising[i] / (n * n);
    }
    return off - apart;
}

Forecast forecast(const BrakeFilter& filter, double c_e_J, const LandingMix& mix, const ForecastSettings& settings) {
    check(mix, settings);
    Forecast out;
    out.c_e_J = c_e_J;
    constexpr double kNever = std::numeric_limits<double>::infinity();
    std::vector<double> now;
    now.reserve(static_cast<std::size_t>(settings.draws));
    out.landings.reserve(now.capacity());
    out.energies_J.reserve(now.capacity());
    int already = 0;
    int crossed = 0;
    int extrapolated = 0;
    for (int n = 0; n < settings.draws; ++n) {
        Future future(filter, c_e_J, mix, settings.seed, n);
        now.push_back(future.friction());
        int landed = 0;
        while (future.friction() >= settings.limit && landed < settings.horizon) {
            future.land();
            ++landed;
        }
        const bool below = future.friction() < settings.limit;
        already += below && landed == 0 ? 1 : 0;
        crossed += below ? 1 : 0;
        extrapolated += future.extrapolates() ? 1 : 0;
        out.landings.push_back(below ? landed : kNever);
        out.energies_J.push_back(below ? future.c_e_J() : kNever);
    }
    std::sort(now.begin(), now.end());
    std::sort(out.landings.begin(), out.landings.end());
    std::sort(out.energies_J.begin(), out.energies_J.end());
    for (std::size_t q = 0; q < kShares.size(); ++q) out.friction_now[q] = quantile(now, kShares[q]);
    take_quantiles(out);
    out.crossed_now = static_cast<double>(already) / settings.draws;
    out.crossed_ever = static_cast<double>(crossed) / settings.draws;
    out.extrapolated = static_cast<double>(extrapolated) / settings.draws;
    const int reach = out.landings_left[2].value_or(settings.horizon);
    if (settings.fan_points > 2) out.fan = fan(filter, c_e_J, mix, settings, std::min(settings.horizon, reach + reach / 10 + 10));
    return out;
}

}  // namespace wear
