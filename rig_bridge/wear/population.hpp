/// What brakes of one kind have in common and how they differ: what a forecast for one of them, and the judgement of its health, start from.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "rig_bridge/wear/model.hpp"

namespace wear {

/// Mean friction over cumulative energy, without scatter, as a fitted model says it: the conditional mean of eq. (14) with every component by
/// its weight, in a table.
class MeanCurve {
  public:
    explicit MeanCurve(const Model& model);

    /// At any c_e. Linear between points of the table, and beyond the data as the model goes on (kHowItExtrapolates).
    [[nodiscard]] double operator()(double c_e_J) const;
    [[nodiscard]] double first_J() const { return first_J_; }  ///< of the data
    [[nodiscard]] double last_J() const { return last_J_; }

  private:
    double first_J_;
    double last_J_;
    double step_J_;
    double slope_before_perJ_;
    double slope_after_perJ_;
    std::vector<double> friction_;
};

/// How single maneuvers scatter about the mean of their brake; friction coefficients.
struct Scatter {
    double memory = 0.0;      ///< of the remembered part, from one maneuver to the next, in [0, 1)
    double remembered = 0.0;  ///< standard deviation of the part that remembers
    double fresh = 0.0;       ///< of the part that does not, > 0
    /// Of the brake's offset from the curves of the population: deviation that 1 MJ adds, growing with the root of energy.
    double drift_per_root_MJ = 0.0;
    bool operator==(const Scatter&) const = default;
};

/// How a brake differs from a member's curve.
struct Spread {
    double log_energy_scale = 0.0;  ///< standard deviation of log s: it takes s times the energy for the same wear
    double offset = 0.0;            ///< standard deviation of the friction offset
    /// What a maneuver says about which member and s are right counts so much less with each maneuver after it, in (0, 1]; 1: never forgotten.
    double evidence_kept = 1.0;
    bool operator==(const Spread&) const = default;
};

/// At which value of its statistics a brake is abnormal (health.hpp). Run-in and wear-out have limits of their own: friction falls there by
/// itself, in each brake at another time.
struct HealthLimits {
    double gradual = 0.0;           ///< of the cumulative sums, in standard normal deviates
    double sudden = 0.0;            ///< of two maneuvers together, likewise
    double trend = 0.0;             ///< of ten maneuvers against what was expected of them, in deviations of the scatter
    double unsteady_gradual = 0.0;  ///< in run-in and wear-out
    double unsteady_sudden = 0.0;
    bool operator==(const HealthLimits&) const = default;
};
using HealthTest = double HealthLimits::*;
inline constexpr std::array<HealthTest, 5> kHealthTests{&HealthLimits::gradual, &HealthLimits::sudden, &HealthLimits::trend,
                                                        &HealthLimits::unsteady_gradual, &HealthLimits::unsteady_sudden};
inline constexpr std::array kHealthTestNames{"gradual", "sudden", "trend", "unsteady_gradual", "unsteady_sudden"};

/// Cumulative energy between which no member runs in or wears out; from == to: there is none such.
struct SteadyStage {
    double from_J = 0.0, to_J = 0.0;
    bool operator==(const SteadyStage&) const = default;
    [[nodiscard]] bool holds(double c_e_J) const { return c_e_J >= from_J && c_e_J <= to_J && to_J > from_J; }
};
/// Where the friction of every curve falls or rises no faster than a few times its own median slope.
[[nodiscard]] SteadyStage steady_stage(const std::vector<MeanCurve>& curves);

/// What forecasts of landings left showed on brakes of the population that were left out of the learning (landings_forecast.hpp).
struct ForecastCalibration {
    double log_misfit = 0.0;                                       ///< mean of the logarithm of LandingsForecast::misfit()
    double misfit_deviation = 0.0;                                 ///< its standard deviation; 0: not known
    using Tenths = std::array<double, 9>;                          ///< at 10 to 90 % of life; between them a straight line
    Tenths filter{1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};    ///< weight of the filter's quantiles beside those of past lives
    Tenths widening{1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};  ///< factor of the distance from the median, for 80 % of lives in the interval
    bool operator==(const ForecastCalibration&) const = default;
    [[nodiscard]] static double at(const Tenths& tenths, double share_of_life);
};

struct Population {
    std::string source;  ///< for people
    Provenance provenance;
    std::vector<Model> models;  ///< of brakes that were worn out, at least one
    Scatter scatter;
    Spread spread;
    HealthLimits limits;
    SteadyStage steady;
    ForecastCalibration calibration;
    std::vector<MeanCurve> members;  ///< the models' curves
    bool operator==(const Population& other) const {
        return source == other.source && provenance == other.provenance && models == other.models && scatter == other.scatter &&
               spread == other.spread && limits == other.limits && steady == other.steady && calibration == other.calibration;
    }
};

/// One brake only is known. How others differ is then assumed: scatter of the size that the model has, half of its variance remembered from
/// one maneuver to the next by half; 10 % in energy, and an offset of 2.5 deviations of the scatter. [A] For forecasts: nothing is abnormal
/// by its limits of 1.
[[nodiscard]] Population brakes_like(const Model& model);
/// The same with health limits from 1,000 simulated brakes of this model, half by each rule of eq. (14); takes half a second.
[[nodiscard]] Population population_of(const Model& model);

}  // namespace wear
