/// Delay until a fault is found in lives by the rival laws (rival_laws.hpp), at one false alarm in a hundred lives: the shipped watch compared with
/// the difference of the means of the newest ten readings and of the ten before.
#pragma once

#include "plant_sim/wear/rival_laws.hpp"
#include "rig_bridge/wear/population.hpp"

namespace wear::arena {

struct Found {
    double healthy = 0.0;     ///< share of healthy lives classified as abnormal
    double glazing_10 = 0.0;  ///< share of lives with glazing of 10 % that is found within kSoon landings
    double glazing_5 = 0.0;
};
struct WatchScore {
    Found watch, difference;
};
constexpr std::size_t kSoon = 25;
constexpr std::size_t kLimitLives = 200;  ///< lives of the law, after those from which the population was learnt, that set the limits of both methods

/// `population` must be learnt from lives of `law`. Judges `lives` lives, with seeds from `first` on.
[[nodiscard]] WatchScore judge_watch(Law law, const Settings& settings, const Population& population, std::uint64_t first, std::size_t lives);

}  // namespace wear::arena
