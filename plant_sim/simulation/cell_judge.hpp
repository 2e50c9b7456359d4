/// What must hold in every period of a cell, whatever fails in it.
#pragma once

#include <functional>
#include <string>

#include "firmware/can/observer.hpp"
#include "plant_sim/plc/served_rig.hpp"
#include "plant_sim/simulation/cell_campaign.hpp"
#include "plant_sim/simulation/permission.hpp"
#include "rig_bridge/rig/sequencer.hpp"

namespace plant_sim::simulation {

/// Of one period.
struct CellNow {
    antiskid::control::Time now{};
    bool loop_lives = false;  ///< the bridge's
    bool plc_answers = false;
    bool controller_lives = false;
    unsigned open = 0;                          ///< interlocks
    const rig::Sequencer* sequencer = nullptr;  ///< none: nothing runs
};

class CellJudge {
  public:
    using Sink = std::function<void(const std::string&)>;

    /// All must outlive it.
    CellJudge(const CellSetup& setup, const rig::Plan& plan, const plc::ServedRig& rig, Sink violated);

    /// Frames as they come whole.
    void controller_hears(const antiskid::can::Frame& frame) { permission_.accept(frame); }
    void rig_hears(const antiskid::can::Frame& frame);
    /// Bridge or controller starts anew.
    void starts_anew() { permission_.forget(); }

    void look(const CellNow& cell);
    void begun() { touchdowns_ = rig_.maneuvers(); }
    void over(const rig::Sequencer& sequencer);

  private:
    void machines(const CellNow& cell);

    const CellSetup& setup_;
    const rig::Plan& plan_;
    const plc::ServedRig& rig_;
    Sink violated_;
    Permission permission_;
    antiskid::can::Observer valve_;
    double top_mps_;
    std::uint32_t touchdowns_ = 0;
    unsigned open_ = 0;
    antiskid::control::Time opened_{}, bridge_seen_{}, plc_answered_{}, controller_lived_{};
};

}  // namespace plant_sim::simulation
