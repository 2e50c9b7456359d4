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

struct FleetOptions {
    int lives = 8;
    std::uint64_t seed = 1;
    Mix mix = Mix::random;
    double missing = 0.0;  ///< share of landings whose figures are lost
    /// Lives differ by so much, lognormal, about the plan's: relative standard deviations.
    double brake_deviation = 0.0, tyre_deviation = 0.0;
    Inspection inspection{};  ///< see LifeOptions, here and below
    std::vector<wear::Range> allowed_on{};
    std::vector<std::size_t> surface_of{};
    std::optional<wear::SurfaceReferences> references{};
    std::optional<wear::LifeForecast> life_forecast{};
    const Bound* bound = nullptr;
    Costs costs{};
    std::size_t scenarios = 0;
    bool worst_stops = true;                            ///< of the first policy's lives
    const std::atomic<bool>* stop = nullptr;            ///< once true nothing more is begun
    std::function<void(std::size_t stops)> on_stops{};  ///< stops so far of all lives
};

struct PolicyLives {
    Policy policy;
    std::vector<Life> lives;
};

/// Makes all these landings, which do not depend on one another, and gives the stops in their order.
using Lander = std::function<std::vector<Stop>(std::span<const LandingRequest>)>;

/// A life's brake and tyre as they really are. The brake is a lining of its own (wear::LiningLaw), with scatter in all of its numbers as in
/// tests/wear/fleet.hpp: of the model that forecasts it knows nothing. A pair has a tenth at least of what is planned: no other is begun.
struct Truth {
    wear::BrakeWear brake;
    double tyre_life_J = 0.0;
};
[[nodiscard]] Truth truth_of(const wear::WearPlan& plan, const wear::BrakeWear& planned, const FleetOptions& options, std::uint64_t life);

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
    double cost = 0.0, loss = 0.0;                   ///< money a landing, to the first limits; of it what the bound would have saved
    double j_mu = 0.0, min_j_mu = 1.0;               ///< mean and least of all stops
    double distance_m = 0.0;                         ///< mean
    bool floor_held = true;
};

/// `feasible`: of each life; the same for every policy, since it is about what was possible.
[[nodiscard]] Summary summary(const PolicyLives& lives, const std::vector<bool>& feasible, double tolerance);

/// The fixed reference in `range`, in steps of 0.01, whose mean tyre share by the table brings both limits nearest to each other: the best that can
/// be chosen once, with the shares known beforehand.
[[nodiscard]] double best_fixed(const wear::WearPlan& plan, const wear::SurfaceTable& table, const wear::Range& range);

}  // namespace regulation
