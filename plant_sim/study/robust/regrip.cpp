#include "plant_sim/study/robust/regrip.hpp"

#include <cmath>
#include <numeric>

namespace robust {

void RegripMeter::update(const rig::Surface& under, double v_mps, double mu) {
    if (over_) return;
    const bool changes = !surface_.empty() && under.name != surface_;
    surface_ = under.name;
    if (changes && !changed_) speed_mps_ = v_mps;
    const auto max = static_cast<std::size_t>(std::lround(kLongest_s / period_s_));
    over_ = (changes && changed_) || (changed_ && shares_.size() == max) || v_mps < kEnds_mps;
    changed_ = changed_ || changes;
    if (changed_ && !over_) shares_.push_back(mu / rig::peak(under, v_mps).mu);
}

std::optional<Regrip> RegripMeter::regrip() const {
    if (!changed_) return std::nullopt;
    Regrip result{.speed_mps = speed_mps_, .judged_s = period_s_ * static_cast<double>(shares_.size()), .regained_s = {}};
    const auto window = static_cast<std::size_t>(std::lround(kWindow_s / period_s_));
    const auto enough = [&](std::size_t at) {
        const auto first = shares_.begin() + static_cast<std::ptrdiff_t>(at);
        return std::accumulate(first, first + static_cast<std::ptrdiff_t>(window), 0.0) >= kShare * static_cast<double>(window);
    };
    const std::size_t windows = shares_.size() < window ? 0 : shares_.size() - window + 1;
    std::size_t kept = windows;  // first window after which all have enough
    while (kept > 0 && enough(kept - 1)) --kept;
    while (kept < windows && shares_[kept] < kShare) ++kept;
    if (kept < windows) result.regained_s = period_s_ * static_cast<double>(kept + 1);
    return result;
}

}  // namespace robust
