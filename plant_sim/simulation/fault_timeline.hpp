/// Determines which of the planned faults are active.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "firmware/control/types.hpp"
#include "plant_sim/simulation/cell_faults.hpp"

namespace plant_sim::simulation {

[[nodiscard]] inline antiskid::control::Time duration(double s) {
    return antiskid::control::Time(std::llround(s * 1e9));
}

class FaultTimeline {
  public:
    /// `begins`: false if the fault ends.
    using Change = std::function<void(const PlannedFault& fault, bool begins)>;

    explicit FaultTimeline(std::span<const PlannedFault> faults);

    /// Call when a phase begins: sets the start time of the faults that wait for it.
    void reached(rig::Phase phase, std::int64_t attempt, antiskid::control::Time now);
    /// Advances to `now` and calls `change` for each fault that begins or ends. False: none did.
    bool advance(antiskid::control::Time now, const Change& change);

    [[nodiscard]] bool any() const;
    [[nodiscard]] std::vector<PlannedFault> active() const;

  private:
    struct Fault {
        PlannedFault planned;
        std::optional<antiskid::control::Time> begins{};
        bool active = false;
        bool over = false;
    };
    std::vector<Fault> faults_;
};

}  // namespace plant_sim::simulation
