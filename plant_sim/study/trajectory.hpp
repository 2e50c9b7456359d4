/// A maneuver as a table over time, one row each 5 ms, CSV with units in the header.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "firmware/can/rig_port.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/study/rig_session.hpp"
#include "rig_bridge/pictures/stop_picture.hpp"

namespace study {

class Trajectory {
  public:
    /// `along_runway`: adds the position on the runway and the friction available there at this speed.
    explicit Trajectory(bool along_runway = false);

    /// Call after each control period with the rig, the decoded status of the controller, and the current that acted.
    void record(const RigSession& session, const antiskid::can::ControllerView& controller, double current_mA);

    [[nodiscard]] std::string_view csv() const { return csv_.text(); }
    /// The same rows for a picture.
    [[nodiscard]] std::span<const pictures::StopRow> rows() const { return rows_; }

  private:
    bool along_runway_;
    settings::TextTable csv_;
    std::vector<pictures::StopRow> rows_;
};

}  // namespace study
