/// Up to eight sessions that advance together, their rigs in plant::RigLanes. Bit by bit what each would do alone.
#pragma once

#include <array>
#include <cstddef>

#include "plant_sim/model/rig_lanes.hpp"
#include "plant_sim/study/rig_session.hpp"

namespace study {

class SessionLanes {
  public:
    static constexpr std::size_t kLanes = plant::RigLanes::kLanes;

    /// What RigSession::advance is given.
    struct Period {
        double current_mA = 0.0;
        antiskid::control::State controller = antiskid::control::State::self_test;
    };

    /// `session`, of single_steps(), takes part until it is replaced or taken out (nullptr); it must outlive that where it is.
    void place(std::size_t lane, RigSession* session);
    /// One period of every session.
    void advance(const std::array<Period, kLanes>& periods);

  private:
    std::array<RigSession*, kLanes> sessions_{};
    plant::RigLanes rigs_;
};

}  // namespace study
