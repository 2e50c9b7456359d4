/// Compares forecasts on lives by laws that none of the forecasts was made from (rival_laws.hpp).
#pragma once

#include <optional>

#include "plant_sim/wear/arena_watch.hpp"
#include "plant_sim/wear/rival_laws.hpp"
#include "rig_bridge/wear/conditional.hpp"

namespace wear::arena {

enum class Method : std::uint8_t {
    persistence,      ///< the next friction is the newest
    past_lives,       ///< the training lives, landing by landing; their length as a lognormal
    nearest,          ///< the mixture of eq. (14), fitted to one training life, from the nearest component
    mixture,          ///< likewise, from all components
    local_linear,     ///< Kalman smoother of level and slope in this life alone
    filter,           ///< the filter and its forecast, learnt from the training lives
    shipped,          ///< life_curves, and past lives where the brake behaves otherwise: what `rig-lab wear forecast` says
    life_curves,      ///< the Gaussian process over the share of life, learnt from the training lives (life_curves.hpp)
    past_lives_read,  ///< past_lives, weighed by readings of the lining
    shipped_read,     ///< shipped, with readings of the lining
    law_told,         ///< told the law, but not the brake: what can be known of its state from its own friction and energies (law_filter.hpp)
    law_told_read,    ///< law_told, with readings of the lining
    oracle,           ///< told the law and the brake's own state; knows neither scatter nor landings to come
};
constexpr std::array kMethodNames{"persistence", "past_lives",      "nearest",      "mixture",  "local_linear",  "filter", "shipped",
                                  "life_curves", "past_lives_read", "shipped_read", "law_told", "law_told_read", "oracle"};

constexpr std::size_t kTenths = 9;  ///< forecasts are made at 10 to 90 % of life

struct LeftScore {
    std::size_t asked = 0;
    double held = 0.0;   ///< share of true values in the 10 to 90 % interval
    double width = 0.0;  ///< mean width of the interval, landings
    double crps = 0.0;   ///< mean, landings
    double skill = 0.0;  ///< reduction of CRPS against past_lives, relative to that of the oracle
};

struct Score {
    double crps = 0.0;       ///< of the next friction, mean
    double log_score = 0.0;  ///< -log p, mean; less is better
    double pit = 0.0;        ///< Kolmogorov's distance of the probability integral transform from uniform
    std::array<LeftScore, kTenths> left{};
    bool forecasts = false;  ///< whether it forecasts the landings left
};

struct Plan {
    Settings settings;
    std::vector<Law> laws;
    std::uint64_t judged_seed = 0;   ///< seed of the first judged life
    std::size_t training_lives = 0;  ///< per law, at least 3
    std::size_t judged_lives = 0;    ///< per law
    bool watch = false;              ///< also judges the detection of faults
    unsigned threads = 1;            ///< the result does not depend on it
};

using Scores = std::array<Score, kMethodNames.size()>;
struct Result {
    Scores within;                                     ///< trained on the judged law
    std::optional<Scores> across;                      ///< trained on each other law in turn; none: there is only one law
    std::vector<Scores> within_by_law, across_by_law;  ///< by the judged law, in the plan's order
    std::vector<WatchScore> watch;                     ///< by law; empty unless the plan requests it
};
[[nodiscard]] Result run(const Plan& plan);

}  // namespace wear::arena
