/// Forecast of the landings left for a brake in use: a mixture of the filter's forecast, to the extent that the brake behaves like its population,
/// and of past lives otherwise. The width of the interval is calibrated on brakes left out of the learning.
///
///     LandingsForecast brake(population);
///     for (each maneuver) brake.learn(point);
///     const Forecast f = brake.forecast(mix, settings);
///
/// To judge whether it behaves like them, the filter's forecasts of friction are compared with later measurements. For a brake of the population, the
/// exponentially weighted mean square error has the distribution found on the left-out brakes; for other brakes it may be any larger value.
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

    /// Adds a point; call in the order of the maneuvers.
    void learn(const Point& point);
    /// Call after at least one point.
    [[nodiscard]] Forecast forecast(const LandingMix& mix, const ForecastSettings& settings) const;

    [[nodiscard]] const BrakeFilter& filter() const { return filter_; }
    /// Exponentially weighted mean square of the filter's standardised errors: about 1 for brakes of the population.
    [[nodiscard]] double misfit() const { return misfit_; }
    /// Probability that the brake is of the population's kind.
    [[nodiscard]] double population_probability() const;

  private:
    struct Expected {
        double at_J, mean, variance;
    };
    [[nodiscard]] Expected expected_at(double c_e_J) const;

    const Population* population_;
    BrakeFilter filter_;
    std::deque<Expected> waiting_;  // forecasts not yet compared
    double reach_J_;                // how far ahead
    double c_e_J_ = 0.0;
    double misfit_ = 1.0;
};

/// `count` equally probable lives, rising, of a brake that is not worn out at `c_e_J`.
[[nodiscard]] std::vector<double> past_lives_J(const PastLives& past, double c_e_J, std::size_t count);
/// Share of the life that is over at `c_e_J`: half by the filter's draws and half by past lives.
[[nodiscard]] double share_of_life(double c_e_J, const std::vector<double>& filter_J, const std::vector<double>& lives_J);

struct Correction {
    double filter, population_probability, widening;
};
/// Combines the filter's draws and as many past lives, both ascending, into one distribution; no value is below `now`.
[[nodiscard]] std::vector<double> corrected(std::vector<double> filter, std::vector<double> lives, double now, const Correction& correction);

}  // namespace wear
