/// Common properties of brakes of one kind and their differences: the prior for forecasts and health monitoring of one of them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "rig_bridge/wear/life_curves.hpp"
#include "rig_bridge/wear/model.hpp"

namespace wear {

/// Mean friction over cumulative energy, without scatter, by a fitted model: a table of the conditional mean of eq. (14), with all components
/// weighted.
class MeanCurve {
  public:
    explicit MeanCurve(const Model& model);

    /// For any c_e: linear between the table's points, beyond the data extrapolated as the model (kHowItExtrapolates).
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

/// Scatter of single maneuvers about the mean of their brake; friction coefficients.
struct Scatter {
    double memory = 0.0;      ///< correlation of the remembered part from one maneuver to the next, in [0, 1)
    double remembered = 0.0;  ///< standard deviation of the correlated part
    double fresh = 0.0;       ///< standard deviation of the uncorrelated part, > 0
    /// Random walk of the brake's offset from the population's curves: standard deviation after 1 MJ, proportional to the root of energy.
    double drift_per_root_MJ = 0.0;
    bool operator==(const Scatter&) const = default;
};

/// How a brake differs from a member's curve.
struct Spread {
    double log_energy_scale = 0.0;  ///< standard deviation of log s: it takes s times the energy for the same wear
    double offset = 0.0;            ///< standard deviation of the friction offset
    /// Factor by which a maneuver's evidence for member and s decreases with each later maneuver, in (0, 1]; 1: never forgotten.
    double evidence_kept = 1.0;
    bool operator==(const Spread&) const = default;
};

/// Test statistics at which a brake is abnormal (health.hpp). Run-in and wear-out have separate limits: friction changes there in healthy brakes, at
/// different times.
struct HealthLimits {
    double gradual = 0.0;           ///< of the cumulative sums, in standard normal deviates
    double sudden = 0.0;            ///< of two maneuvers together, likewise
    double trend = 0.0;             ///< of ten maneuvers against what was expected of them, in deviations of the scatter
    double glazing = 0.0;           ///< of GlazingWatch, where the population has life curves; it takes the place of the trend there
    double unsteady_gradual = 0.0;  ///< in run-in and wear-out
    double unsteady_sudden = 0.0;
    bool operator==(const HealthLimits&) const = default;
};
using HealthTest = double HealthLimits::*;
inline constexpr std::array<HealthTest, 6> kHealthTests{&HealthLimits::gradual, &HealthLimits::sudden,           &HealthLimits::trend,
                                                        &HealthLimits::glazing, &HealthLimits::unsteady_gradual, &HealthLimits::unsteady_sudden};
inline constexpr std::array kHealthTestNames{"gradual", "sudden", "trend", "glazing", "unsteady_gradual", "unsteady_sudden"};

/// Range of cumulative energy in which no member runs in or wears out; from == to: none.
struct SteadyStage {
    double from_J = 0.0, to_J = 0.0;
    bool operator==(const SteadyStage&) const = default;
    [[nodiscard]] bool holds(double c_e_J) const { return c_e_J >= from_J && c_e_J <= to_J && to_J > from_J; }
};
/// The range in which every curve's slope is at most a few times its own median slope.
[[nodiscard]] SteadyStage steady_stage(const std::vector<MeanCurve>& curves);

struct Population {
    std::string source;  ///< for people
    Provenance provenance;
    std::vector<Model> models;  ///< of worn-out brakes, at least one
    Scatter scatter;
    Spread spread;
    HealthLimits limits;
    SteadyStage steady;
    LifeCurves curves;               ///< forecasts of landings left go by these; not known for a population from a single brake
    std::vector<MeanCurve> members;  ///< the models' curves
    bool operator==(const Population& other) const {
        return source == other.source && provenance == other.provenance && models == other.models && scatter == other.scatter &&
               spread == other.spread && limits == other.limits && steady == other.steady && curves == other.curves;
    }
};

/// A population from a single brake, with assumed differences of others: scatter of the size that the model has, half of its variance remembered from
/// one maneuver to the next by half; 10 % in energy, and an offset of 2.5 deviations of the scatter. [A] For forecasts: nothing is abnormal by its
/// limits of 1.
[[nodiscard]] Population brakes_like(const Model& model);
/// The same with health limits from 1,000 simulated brakes of this model, half by each rule of eq. (14); takes half a second.
[[nodiscard]] Population population_of(const Model& model);

}  // namespace wear
