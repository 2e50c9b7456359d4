/// A live line about a maneuver on standard error; plain lines, one a simulated second, where that is no terminal.
#pragma once

#include <string>

#include "firmware/can/rig_port.hpp"
#include "plant_sim/study/rig_session.hpp"

namespace plant_sim {

class Progress {
  public:
    Progress();
    void show(const study::RigSession& session, const antiskid::can::ControllerView& controller);
    /// Ends the live line.
    void finish();

  private:
    bool terminal_;
    double next_s_ = 0.0;
    study::Phase phase_ = study::Phase::done;
    bool shown_ = false;
};

}  // namespace plant_sim
