/// How soon a fault is found in lives by the rival laws (rival_laws.hpp), at one false alarm in a hundred lives: the shipped watch beside the
/// difference of the means of the newest ten readings and the ten before.
#pragma once

#include "plant_sim/wear/rival_laws.hpp"
#include "rig_bridge/wear/population.hpp"

namespace wear::arena {

struct Found {
    double healthy = 0.0;     ///< share of healthy lives called abnormal
    double glazing_10 = 0.0;  ///< share of lives with glazing of 10 % found within kSoon landings of its begin
    double glazing_5 = 0.0;
};
struct WatchScore {
    Found watch, difference;
};
constexpr std::size_t kSoon = 25;
constexpr std::size_t kLimitLives = 200;  ///< of the law, after those that the population was learnt from: both take their limits from these

/// `population` was learnt from lives of the law; judged on `lives` lives from seed `first` on.
[[nodiscard]] WatchScore judge_watch(Law law, const Settings& settings, const Population& population, std::uint64_t first, std::size_t lives);

}  // namespace wear::arena
