/// Up to eight rigs that step together, each by its own current: valves, loads and sensors one after the other, the wheels at once in
/// vector code. Bit by bit what each would do alone.
#pragma once

#include <array>
#include <cstddef>

#include "plant_sim/model/rig.hpp"
#include "plant_sim/model/wheel_lanes.hpp"

namespace plant {

class RigLanes {
  public:
    static constexpr std::size_t kLanes = WheelLanes::kLanes;

    /// `rig` takes part until it is replaced or taken out (nullptr); it must outlive that, and its brake must stay what it is.
    void place(std::size_t lane, Rig* rig);
    /// One step of every rig, the current of its lane held.
    void advance_current(const std::array<double, kLanes>& current_mA);

  private:
    std::array<Rig*, kLanes> rigs_{};
    std::array<Rig::Step, kLanes> under_way_{};
    WheelLanes wheels_;
};

}  // namespace plant
