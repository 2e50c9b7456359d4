/// Forecast of the landings left for a brake in use, and of its next friction: by the life filter, to the extent that the brake behaves like those
/// that were learnt from; otherwise by past lives, and by friction as a level that walks.
///
///     LandingsForecast brake(population);
///     for (each maneuver) brake.learn(point);
///     const Forecast f = brake.forecast(mix, settings);
///
/// Whether it behaves like them is judged by which of the two foretells each next friction: two hypotheses, weighed by Bayes' rule, and
/// a brake may begin to behave otherwise with every maneuver.
#pragma once

#include <optional>

#include "rig_bridge/wear/conditional.hpp"
#include "rig_bridge/wear/forecast.hpp"
#include "rig_bridge/wear/life_filter.hpp"
#include "rig_bridge/wear/lining_likelihood.hpp"
#include "rig_bridge/wear/past_lives.hpp"

namespace wear {

class LandingsForecast {
  public:
    /// `population` must outlive this. Where it has no life curves (it comes from one brake), forecasts are the brake filter's.
    explicit LandingsForecast(const Population& population);
    explicit LandingsForecast(Population&&) = delete;

    /// Adds a point; call in the order of the maneuvers.
    void learn(const Point& point);
    /// Adds a reading of the lining, after the maneuvers before it. Without effect where the population was learnt without readings.
    void read(const LiningReading& reading);
    /// All points and readings of a campaign from point `from` on, and the energy taken since.
    void learn(const Campaign& campaign, std::size_t from = 0);
    /// Call after at least one point.
    [[nodiscard]] Forecast forecast(const LandingMix& mix, const ForecastSettings& settings) const;
    /// Friction of the next maneuver. Likewise.
    [[nodiscard]] Conditional next() const;

    [[nodiscard]] const BrakeFilter& filter() const { return filter_; }
    /// Probability that the brake behaves like those of the population.
    [[nodiscard]] double population_probability() const { return alike_; }

  private:
    static constexpr double kAlike = 0.8;  // before any maneuver [A]
    /// Relative deviation, beyond the population's, of how far the lining of a brake that behaves otherwise is worn when friction ends its life [A].
    static constexpr double kOtherLining = 0.2;

    const Population* population_;
    BrakeFilter filter_;
    std::optional<LifeFilter> life_;
    LiningLikelihood lining_;                    // of a brake that behaves otherwise
    double level_ = 0.0, level_variance_ = 0.0;  // of friction as a level that walks, before the next maneuver
    bool begun_ = false;
    double alike_ = kAlike;
    double c_e_J_ = 0.0;
};

/// `count` equally probable lives, rising, of a brake that is worn out at `c_e_J` with the probability `crossed`, given readings of its lining.
[[nodiscard]] std::vector<double> past_lives_J(const PastLives& past, const LiningLikelihood& lining, double c_e_J, double crossed,
                                               std::size_t count);
/// As many values as in each of two distributions, both rising, of their mixture: `first` with the weight `share`.
[[nodiscard]] std::vector<double> pooled(const std::vector<double>& first, const std::vector<double>& second, double share);

}  // namespace wear
