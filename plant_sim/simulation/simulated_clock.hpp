/// Clocks of a computer, advanced by calls.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "firmware/host/clock.hpp"

namespace plant_sim::simulation {

/// A monotonic clock, and a wall clock that can be set.
class SimulatedClock final : public antiskid::host::Clock {
  public:
    using Time = antiskid::control::Time;

    [[nodiscard]] Time now() override { return now_; }
    [[nodiscard]] Time time() const { return now_; }
    void sleep_until(Time /*deadline*/) override {}
    void advance(Time period) { now_ += period; }
    void set_wall(Time by) { sets_.emplace_back(now_, sets_.back().second + by); }
    [[nodiscard]] Time wall_minus_monotonic(Time at) const {
        const auto set = std::find_if(sets_.rbegin(), sets_.rend() - 1, [at](const auto& one) { return one.first <= at; });
        return set->second;
    }

  private:
    Time now_{1'000'000'000};
    std::vector<std::pair<Time, Time>> sets_{{Time{}, Time{1'764'000'000'000'000'000}}};  // start of each offset, and the offset
};

}  // namespace plant_sim::simulation
