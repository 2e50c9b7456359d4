/// Many lives under several policies, to compare regulation with fixed references.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "plant_sim/study/regulation/life.hpp"

namespace regulation {

struct LivesOptions {
    int lives = 8;
    std::uint64_t seed = 1;
    Mix mix = Mix::random;
    double missing = 0.0;  ///< share of landings without figures
    /// Relative standard deviations of lives about the plan's, lognormal.
    double brake_deviation = 0.0, tyre_deviation = 0.0;
    LifeOptions each{};  ///< of every life, but for policy, brake, tyre and seed
    std::size_t scenarios = 0;
    bool worst_stops = true;                            ///< as in LifeOptions, for the first policy's lives
    const std::atomic<bool>* stop = nullptr;            ///< once true, no more landings start
    std::function<void(std::size_t stops)> on_stops{};  ///< called with the number of stops so far in all lives
};

struct PolicyLives {
    Policy policy;
    std::vector<Life> lives;
};

/// Runs landings, which are independent of each other; returns their stops in the same order.
using Lander = std::function<std::vector<Stop>(std::span<const LandingRequest>)>;

/// True lives of brake and tyre. The brake has its own lining (wear::LiningLaw) with scatter in all parameters as in tests/wear/fleet.hpp; the
/// forecast's model does not contain it. Each life has at least a tenth of the planned energy.
struct Truth {
    wear::BrakeWear brake;
    double tyre_life_J = 0.0;
};
[[nodiscard]] Truth truth_of(const wear::WearPlan& plan, const wear::BrakeWear& planned, const LivesOptions& options, std::uint64_t life);

/// All lives advance together by one landing, so that `land` gets many at once. Empty if it was stopped.
[[nodiscard]] std::vector<PolicyLives> run_lives(const wear::WearPlan& plan, const wear::Rules& rules, const wear::Range& range,
                                                 const std::vector<Policy>& policies, const wear::BrakeWear& brake, const LivesOptions& options,
                                                 const Lander& land);

struct Summary {
    int feasible = 0;            ///< number of lives in which both limits could be met at the planned landing
    int met = 0;                 ///< number of those in which they were met
    int together = 0;            ///< number of all lives in which at the first limit the rest of the other part was within the tolerance
    double first_landing = 0.0;  ///< mean
    double other_left = 0.0;     ///< mean
    double worst_other_left = 0.0;
    double brake_at_plan = 0.0, tyre_at_plan = 0.0;  ///< means
    double cost = 0.0, loss = 0.0;                   ///< money per landing up to the first limits; part of it that the bound would have saved
    double j_mu = 0.0, min_j_mu = 1.0;               ///< mean and minimum of all stops
    double distance_m = 0.0;                         ///< mean
    bool floor_held = true;
};

/// `feasible`: one value per life, the same for every policy.
[[nodiscard]] Summary summary(const PolicyLives& lives, const std::vector<bool>& feasible, double tolerance);

/// The fixed reference in `range`, in steps of 0.01, whose mean tyre share by the table brings the two limits nearest to each other: the best single
/// choice if the shares are known.
[[nodiscard]] double best_fixed(const wear::WearPlan& plan, const wear::SurfaceTable& table, const wear::Range& range);

}  // namespace regulation
