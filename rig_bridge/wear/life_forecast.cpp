#include "rig_bridge/wear/life_forecast.hpp"

#include <cmath>
#include <utility>

#include "rig_bridge/wear/forecast.hpp"

namespace wear {

std::shared_ptr<const wear::Population> forecast_model(const wear::BrakeWear& brake) {
    return std::make_shared<const wear::Population>(wear::brakes_like(*brake.model));
}

LifeForecast::LifeForecast(std::shared_ptr<const wear::Population> model, const wear::BrakeWear& brake, double widest_J)
    : model_(std::move(model)),
      filter_(*model_),
      scale_(brake.scale),
      life_J_(brake.life_J),
      limit_(model_->members.front()(brake.life_J / brake.scale.energy)),
      widest_J_(widest_J) {}

void LifeForecast::learn(double c_e_J, double mean_friction) {
    if (!(std::isfinite(c_e_J) && c_e_J > c_e_J_ && std::isfinite(mean_friction) && mean_friction > 0.0)) return;
    c_e_J_ = c_e_J;
    filter_.learn({c_e_J / scale_.energy, mean_friction / scale_.friction});
}

std::optional<double> LifeForecast::life_J() const {
    // Only energy matters here, not landings: equal steps, small compared with widest_J.
    const double step_J = widest_J_ / 10.0;
    const double to_come_J = kFarthest * life_J_ - c_e_J_;
    if (c_e_J_ <= 0.0 || to_come_J <= step_J) return std::nullopt;
    wear::ForecastSettings settings;
    settings.limit = limit_;
    settings.horizon = static_cast<int>(to_come_J / step_J);
    settings.draws = 100;
    settings.fan_points = 0;
    const wear::LandingMix steps{{"step", 1.0, step_J / scale_.energy, 0.0}};
    const wear::Forecast f = wear::forecast(filter_, c_e_J_ / scale_.energy, steps, settings);
    const auto [early, median, late] = f.crossing_J;
    if (!late || (*late - *early) * scale_.energy > widest_J_) return std::nullopt;
    return *median * scale_.energy;
}

}  // namespace wear
