/// Landings left as they are forecast for a brake in use: by the filter as far as the brake goes as its population did, by past lives as far
/// as it does not, with an interval as wide as brakes that were left out of the learning needed it.
///
///     LandingsForecast brake(population);
///     for (each maneuver) brake.learn(point);
///     const Forecast f = brake.forecast(mix, settings);
///
/// Whether it goes as they did: the filter's forecasts of friction some way ahead are compared with what came. Their mean square misfit, fading,
/// is distributed for brakes of the kind as it was for those that were left out; for others it can be anything that is greater.
#pragma once

#include <deque>
#include <vector>

#include "rig_bridge/wear/forecast.hpp"
#include "rig_bridge/wear/past_lives.hpp"

namespace wear {

class LandingsForecast {
  public:
    /// `population` must outlive this.
    explicit LandingsForecast(const Population& population);
    explicit LandingsForecast(Population&&) = delete;

    /// Points in the order of the maneuvers.
    void learn(const Point& point);
    /// After at least one point.
    [[nodiscard]] Forecast forecast(const LandingMix& mix, const ForecastSettings& settings) const;

    [[nodiscard]] const BrakeFilter& filter() const { return filter_; }
    /// Mean square of the filter's standardised errors, fading: about 1 for brakes of the population's kind.
    [[nodiscard]] double misfit() const { return misfit_; }
    /// Probability that the brake is of the population's kind.
    [[nodiscard]] double alike() const;

  private:
    struct Expected {
        double at_J, mean, variance;
    };
    [[nodiscard]] Expected expected_at(double c_e_J) const;

    const Population* population_;
    BrakeFilter filter_;
    std::deque<Expected> waiting_;  // for the brake to get there
    double reach_J_;                // how far ahead
    double c_e_J_ = 0.0;
    double misfit_ = 1.0;
};

/// `count` equally probable lives, rising, of a brake that is not worn out at `c_e_J`.
[[nodiscard]] std::vector<double> past_lives_J(const PastLives& past, double c_e_J, std::size_t count);
/// That is over at `c_e_J`: half by the filter's draws and half by past lives.
[[nodiscard]] double share_of_life(double c_e_J, const std::vector<double>& filter_J, const std::vector<double>& lives_J);

struct Correction {
    double filter, alike, widening;
};
/// The draws of the filter, and as many of past lives, both rising, made one distribution; nothing comes before `now`.
[[nodiscard]] std::vector<double> corrected(std::vector<double> filter, std::vector<double> lives, double now, const Correction& correction);

}  // namespace wear
