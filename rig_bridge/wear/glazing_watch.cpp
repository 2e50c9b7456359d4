#include "rig_bridge/wear/glazing_watch.hpp"

#include <algorithm>
#include <cmath>

namespace wear {

namespace {

constexpr int kLives = 41;        // of the grid: coarser than a forecast needs
constexpr int kFirst = 5;         // maneuvers until the brake's own level is known a little
constexpr double kMaxGain = 3.0;  // of one maneuver: one outlier is no trend

}  // namespace

GlazingWatch::GlazingWatch(const LifeCurves& curves) : healthy_(curves, kLives) {}

double GlazingWatch::after(const Point& maneuver) {
    if (maneuvers_ >= kFirst && maneuvers_ % kEvery == 0)
        for (const double size : kSizes) supposed_.push_back({healthy_, size, 0, 0.0});
    while (!supposed_.empty() && supposed_.front().age >= kGrowth) supposed_.pop_front();
    ++maneuvers_;
    const double of_healthy = healthy_.log_density(maneuver.mean_friction);
    double greatest = 0.0;
    for (Supposed& s : supposed_) {
        ++s.age;
        const double kept = 1.0 - s.size * s.age / kGrowth;
        const double unglazed = maneuver.mean_friction / kept;
        s.log_ratio += std::clamp(s.brake.log_density(unglazed) - std::log(kept) - of_healthy, -kMaxGain, kMaxGain);
        s.brake.learn({maneuver.c_e_J, unglazed});
        greatest = std::max(greatest, s.log_ratio);
    }
    healthy_.learn(maneuver);
    return greatest;
}

}  // namespace wear
