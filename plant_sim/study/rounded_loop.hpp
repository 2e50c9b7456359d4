/// One maneuver in closed loop with Link::rounded, a period at a time: session, controller and what joins them.
#pragma once

#include <cmath>

#include "firmware/can/rounded_link.hpp"
#include "firmware/control/controller.hpp"
#include "plant_sim/study/in_process.hpp"

namespace study {

[[nodiscard]] inline antiskid::control::Time period_of(const antiskid::control::Config& controller) {
    return antiskid::control::Time(std::llround(static_cast<double>(controller.period_s) * 1e6) * 1000);
}

class RoundedLoop {
  public:
    /// `layout` must outlive the loop.
    RoundedLoop(const antiskid::control::Config& controller, const antiskid::can::Layout& layout,
                const plant::RigParameters& rig, const SessionOptions& options)
        : session_(rig, options),
          controller_(controller),
          period_(period_of(controller)),
          link_(layout, period_) {}

    /// First half of a period: what the sensors say through the link to the controller. The session is to be advanced then, with
    /// `current_mA` and the command's state.
    const antiskid::control::Command& control() {
        now_ = period_ * static_cast<std::int64_t>(result_.steps);
        command_ = controller_.step(link_.sense(session_.sample(), now_), now_);
        current_mA_ = static_cast<double>(link_.current_mA(command_));
        result_.faults.insert(command_.faults);
        ++result_.steps;
        return command_;
    }
    [[nodiscard]] double current_mA() const { return current_mA_; }
    /// What frames would have told the rig of the last control(), without their rounding and their pace.
    [[nodiscard]] antiskid::can::ControllerView view() const {
        return {.command_received = now_,
                .current_mA = static_cast<float>(current_mA_),
                .status_received = now_,
                .state = command_.state,
                .slip = command_.slip,
                .slip_reference = command_.slip_reference,
                .speed_mps = command_.speed_mps,
                .faults_received = now_,
                .faults = command_.faults,
                .road_received = now_,
                .road = command_.road,
                .heartbeat_received = now_};
    }
    [[nodiscard]] RigSession& session() { return session_; }

    [[nodiscard]] RunResult result() const {
        RunResult result = result_;
        result.figures = session_.figures();
        result.came_to_rest = result.figures.standstill;
        return result;
    }

  private:
    RigSession session_;
    antiskid::control::Controller controller_;
    antiskid::control::Time period_;
    antiskid::can::RoundedLink link_;
    antiskid::control::Command command_;
    antiskid::control::Time now_{};
    double current_mA_ = 0.0;
    RunResult result_;
};

}  // namespace study
