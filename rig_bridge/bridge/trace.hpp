/// Samples of a maneuver from touchdown to retract, one per step of the main loop: for a picture, not for figures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rig_bridge/bridge/node.hpp"
#include "rig_bridge/pictures/stop_picture.hpp"

namespace rig::bridge {

class Trace {
  public:
    void record(const Moment& moment);

    /// Rows with time since touchdown.
    [[nodiscard]] std::vector<pictures::StopRow> rows() const;
    /// The same rows with load and torque.
    [[nodiscard]] std::string csv() const;
    /// Time of brake-on since touchdown, s; 0 without brake-on.
    [[nodiscard]] double brake_on_s() const { return brake_on_s_.value_or(0.0); }
    [[nodiscard]] bool empty() const { return rows_.empty(); }

  private:
    struct Row {
        pictures::StopRow stop;
        double load_N = 0.0;
        double torque_Nm = 0.0;
    };
    double began_s_ = 0.0;
    std::optional<double> brake_on_s_;
    std::vector<Row> rows_;
};

}  // namespace rig::bridge
