/// Starting points of EM runs. Internal to fit.
#pragma once

#include "rig_bridge/wear/draw.hpp"
#include "rig_bridge/wear/em.hpp"

namespace wear {

/// Centres drawn from the points as k-means++ does (Arthur and Vassilvitskii 2007), in a metric whose energy axis is stretched by a random
/// factor of 1/4 to 4, so that partitions across and along the trend both occur; then `sweeps` of Lloyd's iteration.
[[nodiscard]] StandardMixture random_start(const StandardPoints& points, std::size_t components, int sweeps, double covariance_floor,
                                           Generator& generator);

/// Splits component `which` into two halves, one standard deviation apart along its longer (`along`) or shorter axis.
[[nodiscard]] StandardMixture split(const StandardMixture& mixture, std::size_t which, bool along);

/// Merges components `a` and `b` into one with the same weight, mean and covariance.
[[nodiscard]] StandardMixture merged(const StandardMixture& mixture, std::size_t a, std::size_t b);

}  // namespace wear
