#include "plant_sim/model/rig_lanes.hpp"

namespace plant {

void RigLanes::place(std::size_t lane, Rig* rig) {
    rigs_[lane] = rig;
    if (rig != nullptr) wheels_.laws.set(lane, rig->dynamics_.law());
}

void RigLanes::advance_current(const std::array<double, kLanes>& current_mA) {
    for (std::size_t i = 0; i < kLanes; ++i) {
        if (rigs_[i] == nullptr) continue;
        Rig& rig = *rigs_[i];
        const Rig::Step& step = under_way_[i] = rig.begin(current_mA[i], current_mA[i]);
        wheels_.inputs.set(i, {rig.state_.v_mps, rig.state_.omega_radps, step.pressure, step.load, step.h});
    }
    wheels_.turn();
    for (std::size_t i = 0; i < kLanes; ++i) {
        if (rigs_[i] == nullptr) continue;
        Rig& rig = *rigs_[i];
        const Rig::Step& step = under_way_[i];
        if (!rig.plain() || !rig.dynamics_.take(rig.state_, wheels_.steps[i])) rig.move(step.pressure, step.load, step.h);
        rig.end(step);
    }
}

}  // namespace plant
