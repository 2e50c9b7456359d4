/// Many lives under several policies: what regulation is worth against fixed references.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plant_sim/study/regulation/life.hpp"

namespace regulation {

struct Policy {
    std::string name;
    std::optional<double> fixed;  ///< none: regulated
};

struct FleetOptions {
    int lives = 8;
    std::uint64_t seed = 1;
    Mix mix = Mix::random;
    double missing = 0.0;          ///< share of landings whose figures are lost
    double brake_deviation = 0.0;  ///< of what a brake really can take more, over the plan's budget, from life to life
    int inspection = 0;            ///< see LifeOptions, here and below
    std::vector<wear::Range> allowed_on{};
    std::optional<wear::LifeForecast> life_forecast{};
    std::size_t scenarios = 0;
    bool worst_stops = true;                            ///< of the regulated lives
    const std::atomic<bool>* stop = nullptr;            ///< once true nothing more is begun
    std::function<void(std::size_t stops)> on_stops{};  ///< stops so far of all lives
};

struct PolicyLives {
    Policy policy;
    std::vector<Life> lives;
};

/// Makes all these landings, which do not depend on one another, and gives the stops in their order.
using Lander = std::function<std::vector<Stop>(std::span<const LandingRequest>)>;

/// All lives advance together, a landing at a time, so that `land` has many to make at once. Empty when it was stopped.
[[nodiscard]] std::vector<PolicyLives> run_fleet(const wear::WearPlan& plan, const wear::Rules& rules, const wear::Range& range,
                                                 const std::vector<Policy>& policies, const wear::BrakeWear& brake, const FleetOptions& options,
                                                 const Lander& land);

struct Summary {
    int feasible = 0;            ///< lives in which both limits could be met at the planned landing
    int met = 0;                 ///< of those, lives in which they were
    int together = 0;            ///< lives, feasible or not, in which at the first limit no more than the tolerance was left of the other
    double first_landing = 0.0;  ///< mean
    double other_left = 0.0;     ///< mean
    double worst_other_left = 0.0;
    double brake_at_plan = 0.0, tyre_at_plan = 0.0;  ///< means
    double j_mu = 0.0, min_j_mu = 1.0;               ///< mean and least of all stops
    double distance_m = 0.0;                         ///< mean
    bool floor_held = true;
};

/// `feasible`: of each life; the same for every policy, since it is about what was possible.
[[nodiscard]] Summary summary(const PolicyLives& lives, const std::vector<bool>& feasible, double tolerance);

/// Of the fixed references on `grid` the one whose mean tyre share `tyre_share` brings both limits nearest to each other: the best that can be
/// chosen once, with the shares known beforehand.
[[nodiscard]] double best_fixed(const wear::WearPlan& plan, const std::vector<double>& grid, const std::vector<double>& tyre_share,
                                const wear::Range& range);

}  // namespace regulation
