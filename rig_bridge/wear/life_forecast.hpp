/// The brake's life as its own friction foretells it: the wear room's forecast, in the energies of the regulator.
///
///     LifeForecast life_forecast(forecast_model(brake), brake, widest_J);
///     for (each landing that was measured) {
///         life_forecast.learn(c_e_J, mean_friction);
///         if (const auto life_J = life_forecast.life_J()) regulator.revise_brake_life(*life_J);
///     }
///
/// Pure. A brake is worn out where its mean friction is what `[brake.wear]` expects at its `life_J`: a brake that wears the faster gets there
/// with less energy. While the friction is on a plateau nobody can tell when it will end, and the forecast is as wide as the population; a
/// forecast that is wider than `widest_J` is therefore none.
#pragma once

#include <memory>
#include <optional>

#include "rig_bridge/wear/brake_filter.hpp"
#include "rig_bridge/wear/wearing_brake.hpp"

namespace wear {

/// What brakes like `brake` have in common, in its model's units: wear::brakes_like() of its model.
[[nodiscard]] std::shared_ptr<const wear::Population> forecast_model(const wear::BrakeWear& brake);

class LifeForecast {
  public:
    /// `widest_J` > 0: of the interval from 10 to 90 %.
    LifeForecast(std::shared_ptr<const wear::Population> model, const wear::BrakeWear& brake, double widest_J);

    /// After a landing, in their order: all that the brake has taken, and its mean friction of eq. (7). What is no number, not positive, or
    /// an energy that went back, is passed over.
    void learn(double c_e_J, double mean_friction);
    /// The energy at which the brake is worn out, median; none: not known well enough, or beyond kFarthest lives.
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
