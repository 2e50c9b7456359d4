/// Forecasts the brake's life from its friction, in the regulator's energies.
///
///     LifeForecast life_forecast(forecast_model(brake), brake, widest_J);
///     for (each landing that was measured) {
///         life_forecast.learn(c_e_J, mean_friction);
///         if (const auto life_J = life_forecast.life_J()) regulator.revise_brake_life(*life_J);
///     }
///
/// Pure. A brake is worn out where its mean friction is what `[brake.wear]` expects at its `life_J`: a faster wearing brake reaches it with less
/// energy. On a friction plateau its end cannot be predicted, and the forecast is as wide as the population; a forecast wider than `widest_J` is
/// therefore not used.
#pragma once

#include <memory>
#include <optional>

#include "rig_bridge/wear/brake_filter.hpp"
#include "rig_bridge/wear/wearing_brake.hpp"

namespace wear {

/// Population for brakes like `brake`, in its model's units: wear::brakes_like() of its model.
[[nodiscard]] std::shared_ptr<const wear::Population> forecast_model(const wear::BrakeWear& brake);

class LifeForecast {
  public:
    /// `widest_J` > 0: largest width of the interval from 10 to 90 %.
    LifeForecast(std::shared_ptr<const wear::Population> model, const wear::BrakeWear& brake, double widest_J);

    /// Call after each landing, in order, with the energy that the brake has taken since new and the mean friction of eq. (7). NaN, values that are
    /// not positive, and a decreasing energy are ignored.
    void learn(double c_e_J, double mean_friction);
    /// Median of the energy at which the brake is worn out; none: too uncertain, or beyond kFarthest lives.
    [[nodiscard]] std::optional<double> life_J() const;

    static constexpr double kFarthest = 1.5;  ///< of `[brake.wear] life_J`

  private:
    std::shared_ptr<const wear::Population> model_;
    wear::BrakeFilter filter_;
    wear::BrakeScale scale_;
    double life_J_;
    double limit_;  // of the model's friction
    double widest_J_;
    double c_e_J_ = 0.0;
};

}  // namespace wear
