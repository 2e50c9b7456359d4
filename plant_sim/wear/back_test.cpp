#include "plant_sim/wear/back_test.hpp"

#include <algorithm>
#include <cmath>

#include "rig_bridge/wear/landings_forecast.hpp"

namespace wear {

namespace {

constexpr std::size_t kNewest = 100;  // maneuvers whose energies are the landings to come

void add(BackTestRow& row, const Forecast& f, int truth, int horizon) {
    const int early = f.landings_left[0].value_or(horizon);
    const int late = f.landings_left[2].value_or(horizon);
    ++row.asked;
    if (truth < early)
        ++row.earlier;
    else if (truth > late)
        ++row.later;
    else
        ++row.held;
    row.mean_width += late - early;
    row.mean_error += std::abs(f.landings_left[1].value_or(horizon) - truth);
}

void finish(BackTestRow& row) {
    if (row.asked == 0) return;
    row.mean_width /= static_cast<double>(row.asked);
    row.mean_error /= static_cast<double>(row.asked);
}

}  // namespace

std::optional<std::size_t> life_by_fit(const Campaign& campaign, double limit, const FitSettings& settings) {
    const MeanCurve curve(model_of(campaign, fit(campaign, settings), settings));
    const auto below = std::find_if(campaign.points.begin(), campaign.points.end(), [&](const Point& p) { return curve(p.c_e_J) < limit; });
    if (below == campaign.points.end()) return std::nullopt;
    return static_cast<std::size_t>(below - campaign.points.begin());
}

BackTest back_test(const Population& population, const std::vector<HeldOut>& brakes, const ForecastSettings& settings,
                   const std::function<void(std::size_t done, std::size_t all)>& progress) {
    BackTest out;
    for (std::size_t r = 0; r < out.rows.size(); ++r) out.rows.at(r).share_of_life = 0.2 * static_cast<double>(r + 1);
    for (std::size_t b = 0; b < brakes.size(); ++b) {
        const HeldOut& brake = brakes[b];
        LandingsForecast forecaster(population);
        Campaign so_far;
        so_far.points.reserve(brake.life);
        auto reading = brake.campaign.readings.begin();
        for (BackTestRow& row : out.rows) {
            const auto at = static_cast<std::size_t>(row.share_of_life * static_cast<double>(brake.life));
            if (at < 2 || at > brake.campaign.points.size()) continue;
            while (so_far.points.size() < at) {
                so_far.points.push_back(brake.campaign.points[so_far.points.size()]);
                forecaster.learn(so_far.points.back());
                for (; reading != brake.campaign.readings.end() && reading->c_e_J <= so_far.points.back().c_e_J; ++reading) forecaster.read(*reading);
            }
            ForecastSettings ask = settings;
            ask.seed = settings.seed + b;
            ask.fan_points = 0;
            const Forecast f = forecaster.forecast(mix_of(so_far, kNewest), ask);
            const int truth = static_cast<int>(brake.life - at);
            add(row, f, truth, settings.horizon);
            add(out.pooled, f, truth, settings.horizon);
        }
        if (progress) progress(b + 1, brakes.size());
    }
    for (BackTestRow& row : out.rows) finish(row);
    finish(out.pooled);
    return out;
}

}  // namespace wear
